//! The shortest wavelength that an instrument shows as it is.

use super::HeightDifferenceCorrelation;

/// A light spot is reliable from this many of its diameters on: a Gaussian spot of 1/e² diameter d
/// damps a wave of wavelength 2 d to `exp(-π²/32) = 0.73` of its amplitude, one of d to 0.29.
pub const WAVELENGTHS_PER_SPOT: f64 = 2.0;

/// What probed a scan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Probe {
    /// 1/e² diameter of the light spot in metres.
    pub spot_diameter: Option<f64>,
    /// Radius of the tip of a stylus in metres.
    pub tip_radius: Option<f64>,
}

impl Probe {
    /// Shortest wavelength in metres that a scan made with the probe shows as it is: not below two
    /// spacings, two spot diameters, or twice the lag from which on the root mean square curvature
    /// stays below half of that of the tip.
    ///
    /// The curvature at a lag is that of second differences,
    /// `sqrt(mean of (z(x+s) - 2 z(x) + z(x-s))^2) / s^2 = sqrt(4 C(s) - C(2 s)) / s^2`. The criterion
    /// is after A. Sanner, W.G. Nöhring, L.A. Thimons, T.D.B. Jacobs, L. Pastewka, Appl. Surf. Sci.
    /// Adv. 7 (2022) 100190, doi:10.1016/j.apsadv.2021.100190, who take the sharpest peak in place
    /// of the mean square. Without a lag at which it holds, the wavelength is as long as the scan.
    pub fn shortest_reliable_wavelength(&self, correlation: &HeightDifferenceCorrelation) -> f64 {
        let samples = 2.0 * correlation.spacing;
        let spot = self.spot_diameter.map_or(0.0, |diameter| WAVELENGTHS_PER_SPOT * diameter);
        let tip = self.tip_radius.map_or(0.0, |radius| 2.0 * tip_lag(correlation, radius));
        samples.max(spot).max(tip)
    }
}

/// The lag in metres from which on a tip of some radius (metres) follows the surface.
fn tip_lag(correlation: &HeightDifferenceCorrelation, radius: f64) -> f64 {
    let lag = |k: usize| k as f64 * correlation.spacing;
    let too_sharp = |&k: &usize| {
        let squares = 4.0 * correlation.values[k] - correlation.values[2 * k];
        // NaN, where no pair is, says nothing.
        squares.max(0.0).sqrt() / lag(k).powi(2) > 0.5 / radius
    };
    let last = (1..=correlation.maximum_lag() / 2).rev().find(too_sharp);
    last.map_or(0.0, |k| lag(k + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `C = level (s / spacing)^(2 H)`.
    fn self_affine(level: f64, hurst: f64) -> HeightDifferenceCorrelation {
        let values = (0..2000).map(|k| level * f64::from(k).powf(2.0 * hurst)).collect();
        HeightDifferenceCorrelation { spacing: 1e-6, variance: 1.0, values, pairs: vec![1; 2000] }
    }

    #[test]
    fn the_coarsest_limit_counts() {
        let correlation = self_affine(1e-20, 0.5);
        let wavelength = |probe: Probe| probe.shortest_reliable_wavelength(&correlation);
        assert_eq!(wavelength(Probe::default()), 2e-6);
        assert_eq!(wavelength(Probe { spot_diameter: Some(0.4e-6), tip_radius: None }), 2e-6);
        assert_eq!(wavelength(Probe { spot_diameter: Some(50e-6), tip_radius: None }), 1e-4);
    }

    #[test]
    fn a_tip_follows_a_self_affine_line_from_where_its_curvature_says() {
        // H = 1/2: 4 C(s) - C(2 s) = 2 level s / spacing, below 1 / (2 R) from
        // s = (8 level R² / spacing)^(1/3) on.
        let (level, radius): (f64, f64) = (1e-15, 5e-6);
        let exact = (8.0 * level * radius * radius / 1e-6).cbrt();
        let probe = Probe { spot_diameter: None, tip_radius: Some(radius) };
        let found = probe.shortest_reliable_wavelength(&self_affine(level, 0.5));
        // The first lag of the scan beyond it.
        assert!(found >= 2.0 * exact && found <= 2.0 * exact + 2e-6, "{found} {exact}");
    }
}
