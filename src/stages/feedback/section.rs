//! Section `[feedback]` of a recipe.

use super::Effect;
use crate::heat::{Road, Thermal, ThermalSetting};
use crate::interface::ShearLaw;
use crate::requirement::{InvalidRecipe, require};
use crate::stages::bem::{Bem, SPEEDS, SPEEDS_MM_S, no_repeats, some_speeds};
use crate::stages::realise::Method;
use crate::units::Units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Section `[feedback]` of a recipe: contacts whose moduli follow from their own heat and strain, beside those of `[bem]`, at its
/// pressures. Rubber and temperature are those of `[bem]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Feedback {
    /// Whether strain softens the rubber, whose file then needs a section `[payne]`.
    pub strain: bool,
    /// Sliding speeds in mm/s, as in `[bem]`: a list, or a range; those of `[bem]` if not set.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "some_speeds")]
    #[schemars(with = "crate::stages::bem::Speeds")]
    pub speeds_mm_s: Option<Vec<f64>>,
    /// Methods whose surfaces are solved, of those of `realise.methods`; all profiles if not set.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub methods: Vec<Method>,
    /// Heat of the contact, if it is to warm the rubber, whose file then needs a section `[temperature]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heat: Option<Heat>,
}

/// Thermal constants of the rubber and time of sliding. They have no defaults: rubbers differ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Heat {
    /// Conductivity of the rubber in W/(m K).
    pub conductivity_w_mk: f64,
    /// Density of the rubber in kg/m³.
    pub density_kg_m3: f64,
    /// Specific heat capacity of the rubber in J/(kg K).
    pub heat_capacity_j_kgk: f64,
    /// Time of sliding in s after which the temperature is read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sliding_time_s: Option<f64>,
    /// Sliding distance in mm in place of the time, such as the length of a block: the time is that over the speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sliding_distance_mm: Option<f64>,
    /// The road as a conductor; an insulated one, which takes no heat, if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub road: Option<RoadBody>,
}

/// Thermal constants of the road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoadBody {
    /// Conductivity of the road in W/(m K).
    pub conductivity_w_mk: f64,
    /// Density of the road in kg/m³.
    pub density_kg_m3: f64,
    /// Specific heat capacity of the road in J/(kg K).
    pub heat_capacity_j_kgk: f64,
    /// Heat-transfer coefficient of the interface in W/(m² K); both surfaces are equally warm where they touch if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heat_transfer_w_m2k: Option<f64>,
}

impl Feedback {
    /// The speeds in mm/s.
    pub fn speeds<'a>(&'a self, bem: &'a Bem) -> &'a [f64] {
        self.speeds_mm_s.as_deref().unwrap_or(&bem.speeds_mm_s)
    }

    /// Whether surfaces of a method are solved; measured ones in both directions.
    pub(super) fn takes(&self, method: Method) -> bool {
        let named = match method {
            Method::MeasuredBackward => Method::Measured,
            method => method,
        };
        self.methods.is_empty() || self.methods.contains(&named)
    }

    /// What is solved: cold for comparison, and all that is asked for.
    pub fn effects(&self) -> Vec<Effect> {
        let asked = |effect: &Effect| {
            (self.strain || !effect.has_strain()) && (self.heat.is_some() || !effect.has_heat())
        };
        Effect::ALL.into_iter().filter(asked).collect()
    }

    /// Checks the section beside the others; `shear` is the law of `[adhesion]`, if the recipe has one.
    pub(crate) fn check(
        &self,
        bem: &Bem,
        realised: &[Method],
        shear: Option<&ShearLaw>,
    ) -> Result<(), InvalidRecipe> {
        if !self.strain && self.heat.is_none() {
            let advice =
                "[feedback] asks for nothing: set strain = true, or give [feedback.heat], or both";
            return Err(InvalidRecipe::Missing { key: "feedback.strain", advice });
        }
        let known =
            self.methods.iter().all(|method| realised.contains(method) && !method.is_areal());
        let names: Vec<&str> = self.methods.iter().map(|method| method.name()).collect();
        require(known, "feedback.methods", names, "profiles of realise.methods")?;
        if bem.pressures_mpa.is_empty() {
            let advice =
                "[feedback] solves contacts at given pressures, such as pressures_mpa = [0.3]";
            return Err(InvalidRecipe::Missing { key: "bem.pressures_mpa", advice });
        }
        if let Some(speeds) = &self.speeds_mm_s {
            let possible = speeds.iter().all(|v| SPEEDS_MM_S.contains(v));
            let valid = !speeds.is_empty() && possible && no_repeats(speeds);
            require(valid, "feedback.speeds_mm_s", speeds, SPEEDS)?;
            self.check_shear(bem, shear)?;
        }
        let Some(heat) = &self.heat else { return Ok(()) };
        if bem.temperature_c.is_none() {
            let advice =
                "[feedback.heat] warms the rubber from its temperature before sliding: state it";
            return Err(InvalidRecipe::Missing { key: "bem.temperature_c", advice });
        }
        heat.check()
    }

    /// A table of shear stresses that ends too early is told before anything is solved.
    fn check_shear(&self, bem: &Bem, shear: Option<&ShearLaw>) -> Result<(), InvalidRecipe> {
        let Some(law) = shear else { return Ok(()) };
        let temperature_c = bem.temperature_c.unwrap_or(20.0);
        for speed_mm_s in self.speeds(bem) {
            let covered = law.stress(speed_mm_s.mm_to_m(), temperature_c).is_ok();
            let required = "within the speeds of adhesion.points (at the reference temperature, where the law shifts): extend the \
                 table, or leave the speed out";
            require(covered, "feedback.speeds_mm_s", speed_mm_s, required)?;
        }
        Ok(())
    }
}

/// Conductivities in W/(m K) that rubbers may have: foams have 0.03, filled ones 0.5, and some with metal 5.
const CONDUCTIVITY: std::ops::RangeInclusive<f64> = 0.01..=10.0;
const CONDUCTIVITY_IN_WORDS: &str = "from 0.01 to 10 W/(m K) (rubbers have 0.1 to 0.5)";
/// Densities in kg/m³ of rubbers.
const DENSITY: std::ops::RangeInclusive<f64> = 100.0..=5000.0;
const DENSITY_IN_WORDS: &str = "from 100 to 5000 kg/m³ (1.15 g/cm³ are 1150)";
/// Heat capacities in J/(kg K) of rubbers.
const CAPACITY: std::ops::RangeInclusive<f64> = 200.0..=5000.0;
const CAPACITY_IN_WORDS: &str = "from 200 to 5000 J/(kg K) (1.5 J/(g K), or kJ/(kg K), are 1500)";
/// Conductivities in W/(m K) of what rubber slides over: from foam to copper.
const ROAD_CONDUCTIVITY: std::ops::RangeInclusive<f64> = 0.01..=1000.0;
const ROAD_CONDUCTIVITY_IN_WORDS: &str = "from 0.01 to 1000 W/(m K) (asphalt has 0.7 to 2.5)";
/// Densities in kg/m³ of what rubber slides over.
const ROAD_DENSITY: std::ops::RangeInclusive<f64> = 100.0..=25_000.0;
const ROAD_DENSITY_IN_WORDS: &str = "from 100 to 25000 kg/m³ (2.7 g/cm³ are 2700)";
/// Heat capacities in J/(kg K) of what rubber slides over.
const ROAD_CAPACITY: std::ops::RangeInclusive<f64> = 50.0..=5000.0;
const ROAD_CAPACITY_IN_WORDS: &str =
    "from 50 to 5000 J/(kg K) (0.85 J/(g K), or kJ/(kg K), are 850)";

impl Heat {
    fn check(&self) -> Result<(), InvalidRecipe> {
        let value = self.conductivity_w_mk;
        let key = "feedback.heat.conductivity_w_mk";
        require(CONDUCTIVITY.contains(&value), key, value, CONDUCTIVITY_IN_WORDS)?;
        let (key, value) = ("feedback.heat.density_kg_m3", self.density_kg_m3);
        require(DENSITY.contains(&value), key, value, DENSITY_IN_WORDS)?;
        let (key, value) = ("feedback.heat.heat_capacity_j_kgk", self.heat_capacity_j_kgk);
        require(CAPACITY.contains(&value), key, value, CAPACITY_IN_WORDS)?;
        self.check_sliding()?;
        self.road.as_ref().map_or(Ok(()), RoadBody::check)
    }

    fn check_sliding(&self) -> Result<(), InvalidRecipe> {
        let key = "feedback.heat.sliding_time_s";
        match (self.sliding_time_s, self.sliding_distance_mm) {
            (None, None) => {
                let advice = "state after which time of sliding in s the temperature is read, or after which distance \
                     (sliding_distance_mm), such as the length of a block";
                Err(InvalidRecipe::Missing { key, advice })
            }
            (Some(seconds), Some(_)) => require(
                false,
                key,
                seconds,
                "left out beside sliding_distance_mm: give one of both",
            ),
            (Some(seconds), None) => {
                let words = "from 1e-9 to 1e6 s (20 ms are 0.02)";
                require((1e-9..=1e6).contains(&seconds), key, seconds, words)
            }
            (None, Some(mm)) => {
                let key = "feedback.heat.sliding_distance_mm";
                require((1e-6..=1e9).contains(&mm), key, mm, "from 1e-6 to 1e9 mm")
            }
        }
    }

    /// Time of sliding in s at a speed in m/s.
    pub fn duration(&self, speed: f64) -> f64 {
        let of_distance = self.sliding_distance_mm.map(|mm| mm.mm_to_m() / speed);
        // A checked section has one of both.
        self.sliding_time_s.or(of_distance).unwrap_or_default()
    }

    /// What the mechanics ask for, at a speed in m/s and under a shear stress of the contact in Pa.
    pub fn setting(&self, speed: f64, shear_stress: f64) -> ThermalSetting {
        ThermalSetting {
            rubber: Thermal {
                conductivity: self.conductivity_w_mk,
                density: self.density_kg_m3,
                heat_capacity: self.heat_capacity_j_kgk,
            },
            duration: self.duration(speed),
            shear_stress,
            road: self.road.as_ref().map(RoadBody::road),
        }
    }
}

impl RoadBody {
    fn check(&self) -> Result<(), InvalidRecipe> {
        let value = self.conductivity_w_mk;
        let key = "feedback.heat.road.conductivity_w_mk";
        require(ROAD_CONDUCTIVITY.contains(&value), key, value, ROAD_CONDUCTIVITY_IN_WORDS)?;
        let (key, value) = ("feedback.heat.road.density_kg_m3", self.density_kg_m3);
        require(ROAD_DENSITY.contains(&value), key, value, ROAD_DENSITY_IN_WORDS)?;
        let (key, value) = ("feedback.heat.road.heat_capacity_j_kgk", self.heat_capacity_j_kgk);
        require(ROAD_CAPACITY.contains(&value), key, value, ROAD_CAPACITY_IN_WORDS)?;
        let Some(value) = self.heat_transfer_w_m2k else { return Ok(()) };
        let key = "feedback.heat.road.heat_transfer_w_m2k";
        let words =
            "from 1 to 1e9 W/(m² K); left out for surfaces that are equally warm where they touch";
        require((1.0..=1e9).contains(&value), key, value, words)
    }

    fn road(&self) -> Road {
        let body = Thermal {
            conductivity: self.conductivity_w_mk,
            density: self.density_kg_m3,
            heat_capacity: self.heat_capacity_j_kgk,
        };
        Road { body: Some(body), transfer: self.heat_transfer_w_m2k }
    }
}
