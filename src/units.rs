//! The one place where a quantity changes its unit.
//!
//! In memory all is SI. Recipes, tables and messages have mm, µm, MPa and mm/s, always in the name. Each conversion is one
//! multiplication or one division by a power of ten that floating point has exactly, so that its result is the nearest
//! number there is. There and back may change the last bit (it does for 3 % of pressures from Pa to MPa and back), so a
//! quantity is converted once, where it is read or written.

/// A number as it stands in another unit.
pub trait Units {
    /// A length in m, in mm; a speed in m/s, in mm/s.
    fn m_to_mm(self) -> f64;
    /// A length in mm, in m; a speed in mm/s, in m/s.
    fn mm_to_m(self) -> f64;
    /// A length in m, in µm.
    fn m_to_um(self) -> f64;
    /// A length in mm, in µm.
    fn mm_to_um(self) -> f64;
    /// A length in µm, in m.
    fn um_to_m(self) -> f64;
    /// A pressure or a modulus in Pa, in MPa.
    fn pa_to_mpa(self) -> f64;
    /// A pressure or a modulus in MPa, in Pa.
    fn mpa_to_pa(self) -> f64;
    /// A mean square height in m², in mm².
    fn m2_to_mm2(self) -> f64;
    /// A mean square height in mm², in m².
    fn mm2_to_m2(self) -> f64;
    /// A spectral density in m³, in mm³.
    fn m3_to_mm3(self) -> f64;
    /// A spectral density in mm³, in m³.
    fn mm3_to_m3(self) -> f64;
    /// A spectral density over the plane in m⁴, in mm⁴.
    fn m4_to_mm4(self) -> f64;
    /// A spectral density over the plane in mm⁴, in m⁴.
    fn mm4_to_m4(self) -> f64;
    /// A wavenumber in rad/m, in rad/mm.
    fn per_m_to_per_mm(self) -> f64;
    /// A wavenumber in rad/mm, in rad/m.
    fn per_mm_to_per_m(self) -> f64;
    /// Bytes in megabytes.
    fn bytes_to_megabytes(self) -> f64;
}

impl Units for f64 {
    fn m_to_mm(self) -> f64 {
        self * 1e3
    }

    fn mm_to_m(self) -> f64 {
        self / 1e3
    }

    fn m_to_um(self) -> f64 {
        self * 1e6
    }

    fn mm_to_um(self) -> f64 {
        self * 1e3
    }

    fn um_to_m(self) -> f64 {
        self / 1e6
    }

    fn pa_to_mpa(self) -> f64 {
        self / 1e6
    }

    fn mpa_to_pa(self) -> f64 {
        self * 1e6
    }

    fn m2_to_mm2(self) -> f64 {
        self * 1e6
    }

    fn mm2_to_m2(self) -> f64 {
        self / 1e6
    }

    fn m3_to_mm3(self) -> f64 {
        self * 1e9
    }

    fn mm3_to_m3(self) -> f64 {
        self / 1e9
    }

    fn m4_to_mm4(self) -> f64 {
        self * 1e12
    }

    fn mm4_to_m4(self) -> f64 {
        self / 1e12
    }

    fn per_m_to_per_mm(self) -> f64 {
        self / 1e3
    }

    fn per_mm_to_per_m(self) -> f64 {
        self * 1e3
    }

    fn bytes_to_megabytes(self) -> f64 {
        self / 1e6
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_the_same_but_for_the_last_bit() {
        let back: [fn(f64) -> f64; 7] = [
            |x| x.m_to_mm().mm_to_m(),
            |x| x.m_to_um().um_to_m(),
            |x| x.pa_to_mpa().mpa_to_pa(),
            |x| x.m2_to_mm2().mm2_to_m2(),
            |x| x.m3_to_mm3().mm3_to_m3(),
            |x| x.m4_to_mm4().mm4_to_m4(),
            |x| x.per_m_to_per_mm().per_mm_to_per_m(),
        ];
        for k in 1..1000 {
            let value = 1.234_567_89e-3 * f64::from(k);
            for there_and_back in back {
                let found = there_and_back(value);
                assert!((found / value - 1.0).abs() <= f64::EPSILON, "{value} {found}");
            }
        }
        assert_eq!((2.5e6_f64.pa_to_mpa(), 50.0_f64.mm_to_m()), (2.5, 0.05));
    }
}
