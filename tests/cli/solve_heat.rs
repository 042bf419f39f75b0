//! `asperity solve heat`.

use super::asperity;
use serde_json::Value;

const CONTACT: &str = "solve heat --wave 0.25:0.012 --wave 1:0.02:1 --pressure 0.3 --rubber data/rubber/example_wlf.toml --points 256";
const RUBBER: &str = "--conductivity 0.3 --density 1150 --heat-capacity 1500";

fn number(result: &Value, key: &str) -> f64 {
    result[key].as_f64().unwrap()
}

#[test]
fn a_fast_contact_is_larger_hot_than_cold_and_its_power_becomes_heat() {
    let arguments = format!("{CONTACT} {RUBBER} --speed 1000 --sliding-time 0.02 --json");
    let result = asperity(&arguments).json();
    let side = |side: &str, key: &str| number(&result[side], key);
    let area = |name: &str| side(name, "contact_area_fraction");
    assert!(area("hot") > 1.05 * area("cold"), "{result}");
    let power = number(&result, "power_w_m2");
    assert!((number(&result, "heat_w_m2") / power - 1.0).abs() < 1e-8);
    // mu p v of the hot contact, as far as the grid tells friction.
    let friction = side("hot", "friction_coefficient") * 0.3e6;
    assert!((power / friction - 1.0).abs() < 0.05, "{power} {friction}");
    assert!(number(&result, "contact_rise_k") > 0.1);
    assert_eq!(number(&result, "temperature_c"), 20.0);
    assert_eq!(result["wave_rise_k"].as_array().unwrap().len(), 127);
    let first = &result["wave_shift_factor"][0];
    assert!(first.as_f64().unwrap() < 1.0, "{first}");
    // The same time as a distance.
    let distance = arguments.replace("--sliding-time 0.02", "--sliding-distance-mm 20");
    let same = asperity(&distance).json();
    let rises = [&same, &result].map(|r| number(r, "contact_rise_k"));
    assert!((rises[0] / rises[1] - 1.0).abs() < 1e-6, "{rises:?}");
    let road = "--road-conductivity 2.5 --road-density 2700 --road-heat-capacity 850";
    let cooled = asperity(&format!("{arguments} {road}")).json();
    assert!(number(&cooled, "contact_rise_k") < rises[1]);
    assert!(number(&cooled, "road_flux_w_m2") > 0.0);
}

#[test]
fn what_heat_needs_is_asked_for() {
    let error = asperity(&format!("{CONTACT} {RUBBER} --speed 10")).error(2);
    assert!(error.contains("--sliding-time"), "{error}");
    let plain = CONTACT.replace("--rubber data/rubber/example_wlf.toml", "");
    let error = asperity(&format!("{plain} {RUBBER} --speed 10 --sliding-time 1")).error(2);
    assert!(error.contains("section [temperature]"), "{error}");
    let error = asperity(&format!("{CONTACT} {RUBBER} --speed 10 --sliding-time -1")).error(2);
    assert!(error.contains("-1"), "{error}");
}
