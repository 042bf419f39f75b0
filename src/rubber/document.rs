//! A rubber as the text of its file.

use super::law;
use super::payne::{Payne, PayneCurve};
use crate::units::Units;
use asperity_core::rubber::{
    Extrapolation, RubberData, RubberModel, ShiftLaw, TemperatureDependence, VerticalShift,
    Viscoelastic,
};
use std::f64::consts::TAU;

/// A rubber as the TOML that [`read_rubber_data`](super::read_rubber_data) reads, numbers with seven
/// significant digits; tables stand in the file itself.
pub fn to_toml(data: &RubberData, source: &str) -> String {
    let text = |text: &str| toml::Value::String(text.into()).to_string();
    let mut lines = Vec::new();
    lines.push(
        match &data.rubber {
            RubberModel::Maxwell(_) => {
                "# A generalised Maxwell model,\n\
             # E(w) = equilibrium_modulus + sum_k modulus_k i w tau_k / (1 + i w tau_k)."
            }
            RubberModel::Table(_) => "# A table of storage and loss modulus over frequency.",
        }
        .to_owned(),
    );
    lines.push(format!("name = {}", text(data.rubber.name())));
    lines.push(format!("source = {}", text(source)));
    match &data.rubber {
        RubberModel::Maxwell(rubber) => lines.push(format!(
            "equilibrium_modulus_mpa = {:.6e}",
            rubber.equilibrium_modulus.pa_to_mpa()
        )),
        RubberModel::Table(table) => {
            lines.push("modulus_kind = \"youngs\"".into());
            lines.push(format!(
                "extrapolate = \"{}\"",
                match table.extrapolation() {
                    Extrapolation::Refuse => "refuse",
                    Extrapolation::Hold => "hold",
                }
            ));
        }
    }
    lines.push(format!("poisson_ratio = {}", data.rubber.poisson_ratio()));
    if let (Some(range), RubberModel::Maxwell(_)) = (&data.measured, &data.rubber) {
        lines.push("# Frequencies of the measurement, at the reference temperature.".into());
        lines.push(format!("measured_hz = [{:.6e}, {:.6e}]", range.lowest_hz, range.highest_hz));
    }
    if let Some(dependence) = &data.temperature {
        temperature(dependence, &mut lines);
    }
    lines.extend(data.payne.as_ref().map(payne_section));
    match &data.rubber {
        RubberModel::Maxwell(rubber) => {
            lines.extend(law::to_lines(rubber.finite_strain));
            for branch in &rubber.branches {
                lines.push("\n[[branches]]".into());
                lines.push(format!("modulus_mpa = {:.6e}", branch.modulus.pa_to_mpa()));
                lines.push(format!("relaxation_time_s = {:.6e}", branch.relaxation_time));
            }
        }
        RubberModel::Table(table) => {
            for point in table.points() {
                lines.push("\n[[moduli]]".into());
                lines.push(format!("frequency_hz = {:.6e}", point.angular_frequency / TAU));
                lines.push(format!("storage_mpa = {:.6e}", point.storage_modulus.pa_to_mpa()));
                lines.push(format!("loss_mpa = {:.6e}", point.loss_modulus.pa_to_mpa()));
            }
        }
    }
    lines.join("\n") + "\n"
}

fn temperature(dependence: &TemperatureDependence, lines: &mut Vec<String>) {
    lines.push("\n[temperature]".into());
    lines.push(format!("reference_c = {:?}", dependence.reference_c));
    if let Some([lowest, highest]) = dependence.measured_c {
        lines.push(format!("measured_c = [{lowest:?}, {highest:?}]"));
    }
    match &dependence.law {
        ShiftLaw::Wlf { c1, c2_k } => {
            lines.push(format!("wlf = {{ c1 = {c1:.6e}, c2_k = {c2_k:.6e} }}"));
        }
        ShiftLaw::Arrhenius { activation_energy_kj_mol: energy } => {
            lines.push(format!("arrhenius = {{ activation_energy_kj_mol = {energy:.6e} }}"));
        }
        ShiftLaw::Table(_) => {}
    }
    if let Some(vertical) = dependence.vertical {
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
    if let ShiftLaw::Table(table) = &dependence.law {
        for factor in table.factors() {
            lines.push("\n[[temperature.shift]]".into());
            lines.push(format!("temperature_c = {:?}", factor.temperature_c));
            lines.push(format!("log10_shift = {:.6e}", factor.log10_shift));
        }
    }
}

/// The section `[payne]` of a rubber file: factors over the amplitude of elongation, numbers with seven significant digits.
pub fn payne_section(payne: &Payne) -> String {
    let mut lines = vec![
        "\n# Softening with strain: E'(strain) = E'(0) f, E''(strain) = E''(0) g; strains are parts of one.".into(),
        "[payne]".to_owned(),
        "strain_kind = \"elongation\"".into(),
    ];
    let list = |rows: &[[f64; 3]], column: usize| {
        let numbers: Vec<String> = rows.iter().map(|row| format!("{:.6e}", row[column])).collect();
        format!("[{}]", numbers.join(", "))
    };
    for (temperature_c, curve) in payne.curves() {
        lines.push(match curve {
            PayneCurve::Kraus(_) => "\n[[payne.kraus]]".into(),
            PayneCurve::Table(_) => "\n[[payne.table]]".into(),
        });
        lines.extend(temperature_c.map(|celsius| format!("temperature_c = {celsius:?}")));
        match curve {
            PayneCurve::Kraus(law) => lines.extend(
                [
                    ("critical_strain", law.critical_strain),
                    ("exponent", law.exponent),
                    ("storage_limit", law.storage_limit),
                    ("loss_limit", law.loss_limit),
                    ("loss_peak", law.loss_peak),
                    ("highest_strain", law.highest_strain),
                ]
                .map(|(key, value)| format!("{key} = {value:.6e}")),
            ),
            PayneCurve::Table(table) => {
                lines.push(format!("strain = {}", list(table.rows(), 0)));
                lines.push(format!("storage_factor = {}", list(table.rows(), 1)));
                lines.push(format!("loss_factor = {}", list(table.rows(), 2)));
            }
        }
    }
    lines.join("\n")
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
        for (law, vertical) in laws.into_iter().flat_map(|law| verticals.map(|v| (law.clone(), v)))
        {
            let rubber = Rubber { name: "a \"tread\" \\ ö".into(), ..Rubber::table_2_1() };
            let measured = Some(FrequencyRange { lowest_hz: 0.1, highest_hz: 1.5e7 });
            let measured_c = Some([-30.0, 60.5]);
            let temperature =
                Some(TemperatureDependence { reference_c: 20.0, law, measured_c, vertical });
            let data = RubberData { measured, temperature, ..rubber.into() };
            let text = to_toml(&data, "sweep.csv");
            assert_eq!(parse_rubber_data(Path::new("tread.toml"), &text).unwrap(), data);
        }
        let plain = RubberData::from(Rubber::elastic(3e6, 0.5));
        assert_eq!(parse_rubber_data(Path::new("e.toml"), &to_toml(&plain, "")).unwrap(), plain);
    }
}
