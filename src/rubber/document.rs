//! A rubber as the text of its file.

use super::law;
use crate::units::Units;
use asperity_core::rubber::{RubberData, ShiftLaw, VerticalShift};

/// A rubber as the TOML that [`read_rubber_data`](super::read_rubber_data) reads, numbers with seven
/// significant digits.
pub fn to_toml(data: &RubberData, source: &str) -> String {
    let rubber = &data.rubber;
    let text = |text: &str| toml::Value::String(text.into()).to_string();
    let mut lines = vec![
        "# A generalised Maxwell model,".into(),
        "# E(w) = equilibrium_modulus + sum_k modulus_k i w tau_k / (1 + i w tau_k).".into(),
        format!("name = {}", text(&rubber.name)),
        format!("source = {}", text(source)),
        format!("equilibrium_modulus_mpa = {:.6e}", rubber.equilibrium_modulus.pa_to_mpa()),
        format!("poisson_ratio = {}", rubber.poisson_ratio),
    ];
    if let Some(range) = &data.measured {
        lines.push("# Frequencies of the measurement, at the reference temperature.".into());
        lines.push(format!("measured_hz = [{:.6e}, {:.6e}]", range.lowest_hz, range.highest_hz));
    }
    if let Some(temperature) = &data.temperature {
        lines.push("\n[temperature]".into());
        lines.push(format!("reference_c = {:?}", temperature.reference_c));
        if let Some([lowest, highest]) = temperature.measured_c {
            lines.push(format!("measured_c = [{lowest:?}, {highest:?}]"));
        }
        lines.push(match temperature.law {
            ShiftLaw::Wlf { c1, c2_k } => {
                format!("wlf = {{ c1 = {c1:.6e}, c2_k = {c2_k:.6e} }}")
            }
            ShiftLaw::Arrhenius { activation_energy_kj_mol: energy } => {
                format!("arrhenius = {{ activation_energy_kj_mol = {energy:.6e} }}")
            }
        });
    }
    if let Some(vertical) = data.temperature.and_then(|temperature| temperature.vertical) {
        lines.push("# Factor of all moduli at another temperature.".into());
        lines.push(match vertical {
            VerticalShift::RhoT { expansion_per_k } => {
                format!("vertical = {{ rho_t = {{ expansion_per_k = {expansion_per_k:e} }} }}")
            }
            VerticalShift::Power { exponent } => {
                format!("vertical = {{ power = {{ exponent = {exponent:.6e} }} }}")
            }
        });
    }
    lines.extend(law::to_lines(rubber.finite_strain));
    for branch in &rubber.branches {
        lines.push("\n[[branches]]".into());
        lines.push(format!("modulus_mpa = {:.6e}", branch.modulus.pa_to_mpa()));
        lines.push(format!("relaxation_time_s = {:.6e}", branch.relaxation_time));
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::{FrequencyRange, Rubber, TemperatureDependence, parse_rubber_data};
    use std::path::Path;

    #[test]
    fn what_is_written_is_read_again() {
        let laws = [
            ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 },
            ShiftLaw::Arrhenius { activation_energy_kj_mol: 90.0 },
        ];
        let verticals = [
            None,
            Some(VerticalShift::RhoT { expansion_per_k: 6.6e-4 }),
            Some(VerticalShift::Power { exponent: 1.25 }),
        ];
        for (law, vertical) in laws.into_iter().flat_map(|law| verticals.map(|v| (law, v))) {
            let rubber = Rubber { name: "a \"tread\" \\ ö".into(), ..Rubber::table_2_1() };
            let measured = Some(FrequencyRange { lowest_hz: 0.1, highest_hz: 1.5e7 });
            let measured_c = Some([-30.0, 60.5]);
            let temperature =
                Some(TemperatureDependence { reference_c: 20.0, law, measured_c, vertical });
            let data = RubberData { rubber, measured, temperature };
            let text = to_toml(&data, "sweep.csv");
            assert_eq!(parse_rubber_data(Path::new("tread.toml"), &text).unwrap(), data);
        }
        let plain = RubberData::from(Rubber::elastic(3e6, 0.5));
        assert_eq!(parse_rubber_data(Path::new("e.toml"), &to_toml(&plain, "")).unwrap(), plain);
    }
}
