//! The section `[realise]` of a recipe.

use super::Method;
use crate::requirement::{InvalidRecipe, require};
use crate::surface::Closure;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Section `[realise]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Realise {
    /// How surfaces are made of the road, in one way or several: `measured`, every window of the scans made periodic;
    /// `matched`, the spectrum and the heights of a window with other phases; `random-phase`, its spectrum with random
    /// phases; `sines`, the fitted sines with random phases; `isotropic`, areal surfaces of random phases whose lines have the
    /// averaged spectrum of the scans. Where maps are kept (`[ingest.maps]`), the first three make areal surfaces of them too.
    #[serde(default = "sines_alone", skip_serializing_if = "is_sines_alone")]
    pub methods: Vec<Method>,
    /// Whether the line scans make surfaces too where maps are kept.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub profiles: bool,
    /// Number of areal surfaces that are drawn of each method; that of `realisations`, at most 8, if not set: an areal surface
    /// has far less scatter than a profile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub areal_realisations: Option<u32>,
    /// Period in mm of isotropic surfaces; the length of a window of the scans if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub isotropic_period_mm: Option<f64>,
    /// Directions in which the rubber slides over `measured` windows: a road is not the same in both.
    #[serde(default = "forward_alone", skip_serializing_if = "is_forward_alone")]
    pub directions: Vec<Direction>,
    /// How a window is made periodic; `mirror` if not set, which makes both directions the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Closure>,
    /// Shortest wavelength in mm of the surfaces of windows; that of the fitted sines if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortest_wavelength_mm: Option<f64>,
    /// Longest gap in mm that is filled by a straight line; windows with longer ones are left out. Eight shortest
    /// wavelengths if not set. What was filled stands in the table of the profiles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_gap_mm: Option<f64>,
    /// Most windows that are taken, the first ones; all if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most_windows: Option<u32>,
    /// Numbers of waves of the approximations to realise, out of `approximate.waves`; for `sines`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waves: Vec<u32>,
    /// Number of realisations; the average is over them. `measured` has as many as there are windows. Where the recipe
    /// has a `tolerance`, their number follows from it and not from this key, which may then be left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub realisations: Option<u32>,
    /// Most realisations that a `tolerance` may take, 1000 if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most_realisations: Option<u32>,
    /// Seed of the phases: same seed, same surfaces, on every machine. Left out beside `sweep.seeds`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
}

impl Realise {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        self.check_methods()?;
        let keys = [
            ("realise.realisations", self.realisations),
            ("realise.most_realisations", self.most_realisations),
            ("realise.areal_realisations", self.areal_realisations),
        ];
        for (key, count) in keys.into_iter().filter_map(|(key, count)| Some((key, count?))) {
            require((1..=100_000).contains(&count), key, count, "1 to 100000")?;
        }
        let (lines, maps) = (self.drawn() > 0, self.areal_drawn() > 0);
        let is_drawn = |method: &Method| match method {
            Method::Measured => true,
            Method::Sines => lines,
            Method::Isotropic => maps,
            _ => lines || maps && !self.profiles,
        };
        if !self.methods.iter().all(is_drawn) {
            let advice = "give a number of surfaces, or a `tolerance` that it follows from";
            return Err(InvalidRecipe::Missing { key: "realise.realisations", advice });
        }
        // TOML's integers are signed.
        let seed = self.seed.unwrap_or_default();
        require(seed < 1 << 63, "realise.seed", seed, "below 2^63")
    }

    fn check_methods(&self) -> Result<(), InvalidRecipe> {
        let names = |methods: &[Method]| methods.iter().map(|m| m.name()).collect::<Vec<_>>();
        let methods = &self.methods;
        let once = methods.iter().enumerate().all(|(i, a)| !methods[..i].contains(a));
        let known = methods.iter().all(|method| method.is_a_choice());
        let wanted = "one or several of measured, matched, random-phase, sines and isotropic, each once \
                      (directions: realise.directions; areal surfaces of maps: a section [ingest.maps])";
        let valid = !methods.is_empty() && once && known;
        require(valid, "realise.methods", names(methods), wanted)?;
        let sines = methods.contains(&Method::Sines);
        let wanted = "at least one number for the method sines, or none without it";
        require(sines != self.waves.is_empty(), "realise.waves", &self.waves, wanted)?;
        let directions = &self.directions;
        let once = directions.iter().enumerate().all(|(i, a)| !directions[..i].contains(a));
        let wanted = "forward, backward or both, each once";
        require(once && !directions.is_empty(), "realise.directions", directions, wanted)?;
        let mirrored = self.periodic.unwrap_or_default() == Closure::Mirror;
        let wanted = "forward alone where windows are mirrored, which makes both directions the same: set \
                      realise.periodic = \"blend\"";
        let backward = directions.contains(&Direction::Backward);
        require(!backward || !mirrored, "realise.directions", directions, wanted)?;
        let wanted = "left out unless realise.methods names measured";
        let measured = methods.contains(&Method::Measured);
        require(measured || !backward, "realise.directions", directions, wanted)?;
        let lengths = [
            ("realise.shortest_wavelength_mm", self.shortest_wavelength_mm),
            ("realise.longest_gap_mm", self.longest_gap_mm),
        ];
        for (key, length) in lengths.into_iter().filter_map(|(key, mm)| Some((key, mm?))) {
            require(length > 0.0 && length.is_finite(), key, length, "positive and finite")?;
            let wanted = "left out unless realise.methods has surfaces of windows";
            require(self.names_windows() || self.is_isotropic(), key, length, wanted)?;
        }
        if let Some(period) = self.isotropic_period_mm {
            let key = "realise.isotropic_period_mm";
            let wanted = "positive, and left out unless realise.methods names isotropic";
            require(
                period > 0.0 && period.is_finite() && self.is_isotropic(),
                key,
                period,
                wanted,
            )?;
        }
        let windows = self.most_windows.unwrap_or(1);
        require(windows > 0, "realise.most_windows", windows, "1 or more")
    }

    /// A warning of every key that does nothing, with why; `maps` where maps are kept.
    pub(super) fn idle_keys(&self, maps: bool) -> Vec<String> {
        let draws_maps = self.is_isotropic()
            || maps && self.methods.iter().any(|m| m.of_a_window() && *m != Method::Measured);
        let windows = "no method makes surfaces of windows";
        let keys = [
            (
                "directions",
                !is_forward_alone(&self.directions) && !self.has_windows(),
                "realise.profiles = false leaves no profile to slide over; directions over maps are areal.angles_deg",
            ),
            (
                "areal_realisations",
                self.areal_realisations.is_some() && !draws_maps,
                "no areal surface is drawn: every window of a map is a measured one",
            ),
            ("periodic", self.periodic.is_some() && !self.names_windows(), windows),
            ("longest_gap_mm", self.longest_gap_mm.is_some() && !self.names_windows(), windows),
            ("most_windows", self.most_windows.is_some() && !self.names_windows(), windows),
        ];
        let idle = keys.into_iter().filter(|(_, idle, _)| *idle);
        idle.map(|(key, _, why)| format!("realise.{key} does nothing: {why}")).collect()
    }

    /// Whether there are profiles of windows of the scans.
    pub fn has_windows(&self) -> bool {
        self.profiles && self.names_windows()
    }

    /// Whether a method makes surfaces of windows, of line scans or of maps.
    pub fn names_windows(&self) -> bool {
        self.methods.iter().any(|method| method.of_a_window())
    }

    /// Whether there are isotropic areal surfaces.
    pub fn is_isotropic(&self) -> bool {
        self.methods.contains(&Method::Isotropic)
    }

    /// Whether there are surfaces whose phases are drawn.
    pub(crate) fn draws(&self) -> bool {
        self.methods.iter().any(|method| *method != Method::Measured)
    }

    /// Number of surfaces that are drawn: as many as there may be need of. To draw one costs nothing.
    pub fn drawn(&self) -> u32 {
        self.most_realisations.or(self.realisations).unwrap_or(0)
    }

    /// Number of areal surfaces that are drawn of each method.
    pub fn areal_drawn(&self) -> u32 {
        self.areal_realisations.unwrap_or(self.drawn().min(MOST_AREAL))
    }
}

/// Most areal surfaces that are drawn unless the recipe says otherwise.
const MOST_AREAL: u32 = 8;

fn yes() -> bool {
    true
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_yes(flag: &bool) -> bool {
    *flag
}

fn sines_alone() -> Vec<Method> {
    vec![Method::Sines]
}

fn is_sines_alone(methods: &[Method]) -> bool {
    methods == [Method::Sines]
}

fn forward_alone() -> Vec<Direction> {
    vec![Direction::Forward]
}

fn is_forward_alone(directions: &[Direction]) -> bool {
    directions == [Direction::Forward]
}

/// The direction in which rubber slides over a measured window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// As the positions of the scan ascend.
    Forward,
    /// The other way.
    Backward,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_do_nothing_are_named() {
        let idle = |text: &str, maps: bool| {
            let realise: Realise = toml::from_str(text).unwrap();
            let told = realise.idle_keys(maps);
            told.iter().map(|text| text.split(' ').next().unwrap().to_owned()).collect::<Vec<_>>()
        };
        let alone = "methods = [\"measured\"]\nperiodic = \"blend\"\nprofiles = false\n";
        let both = format!("{alone}directions = [\"forward\", \"backward\"]");
        assert_eq!(idle(&both, true), ["realise.directions"]);
        assert!(idle(alone, true).is_empty());
        let drawn = format!("{alone}areal_realisations = 3");
        assert_eq!(idle(&drawn, true), ["realise.areal_realisations"]);
        assert!(idle(&drawn.replace("measured", "matched"), true).is_empty());
        let isotropic = "methods = [\"isotropic\"]\nareal_realisations = 3\nlongest_gap_mm = 1.0\nmost_windows = 2";
        assert_eq!(idle(isotropic, false), ["realise.longest_gap_mm", "realise.most_windows"]);
    }
}
