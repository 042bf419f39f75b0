//! The ladder of waves: from the shortest that the spacing of the scans resolves to half their length.

use asperity::units::Units;

/// The ladder of the thesis: its shortest wave in mm and the number of its waves.
const LADDER: (f64, u32) = (0.0625, 8);
/// Points that the shortest wave needs.
const POINTS_ON_SHORTEST: f64 = 8.0;
/// Lateral resolution in shortest waves where the scan is finer: two points of it are 0.8 waves.
const RESOLUTION: f64 = 0.8;
/// Scans must be twice as long as a wave, to tell it from form.
const LENGTHS_IN_SCAN: f64 = 2.0;
/// Fewest waves of a short scan; its shortest wave is below that of the thesis then.
const FEWEST_WAVES: i32 = 3;
/// Largest relative difference of spacings that are taken as equal, as in ingest.
const SAME_SPACING: f64 = 1e-3;

/// Points of a scan and their distance in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub(super) points: usize,
    pub(super) spacing: f64,
}

impl Extent {
    /// From increasing positions; `None` for fewer than two.
    pub(super) fn of(positions: &[f64]) -> Option<Self> {
        let [first, .., last] = positions[..] else { return None };
        let steps = positions.len() - 1;
        Some(Self { points: positions.len(), spacing: (last - first).abs() / steps as f64 })
    }

    /// Length in m: one spacing for each point.
    pub(super) fn length(self) -> f64 {
        self.points as f64 * self.spacing
    }
}

/// The lengths of the recipe.
pub(super) struct Ladder {
    pub(super) shortest_wavelength_mm: f64,
    pub(super) waves: u32,
    /// Set if the scans are finer than the shortest wave needs.
    pub(super) lateral_resolution_um: Option<f64>,
    /// Set if the scans have different lengths.
    pub(super) window_length_mm: Option<f64>,
    pub(super) notes: Vec<String>,
}

impl Ladder {
    /// The ladder that all scans resolve; that of the thesis without scans.
    pub(super) fn of(extents: &[Extent]) -> Self {
        let (shortest_wavelength_mm, waves) = LADDER;
        let mut ladder = Self {
            shortest_wavelength_mm,
            waves,
            lateral_resolution_um: None,
            window_length_mm: None,
            notes: Vec::new(),
        };
        let spacings = range(extents.iter().map(|extent| extent.spacing));
        let lengths = range(extents.iter().map(|extent| extent.length()));
        let (Some((finest, coarsest)), Some((shortest, longest))) = (spacings, lengths) else {
            return ladder;
        };
        let length = ladder.window(extents, shortest, longest, coarsest);
        ladder.fit(coarsest, length);
        let between = |from: f64, to: f64, unit: &str| match to - from > SAME_SPACING * to {
            true => format!("{from:.2} to {to:.2} {unit}"),
            false => format!("{to:.2} {unit}"),
        };
        ladder.notes.push(format!(
            "{} scan{}, {} long, {} between points: {} waves from {} mm",
            extents.len(),
            if extents.len() == 1 { "" } else { "s" },
            between(shortest.m_to_mm(), longest.m_to_mm(), "mm"),
            between(finest.m_to_um(), coarsest.m_to_um(), "um"),
            ladder.waves,
            ladder.shortest_wavelength_mm
        ));
        if coarsest - finest > SAME_SPACING * coarsest {
            ladder.notes.push(
                "the spacings differ, and ingest takes one: export the scans at one spacing, or make a recipe for each"
                    .into(),
            );
        }
        ladder
    }

    /// Cuts windows of one length if the scans differ in length; returns the length of a scan in m.
    fn window(&mut self, extents: &[Extent], shortest: f64, longest: f64, spacing: f64) -> f64 {
        if extents.iter().all(|extent| extent.points == extents[0].points)
            || longest - shortest < spacing
        {
            return shortest;
        }
        // Rounded down to three digits: round-off may make a window of the exact length too long.
        let unit = 10.0_f64.powf((shortest.m_to_mm()).log10().floor() - 2.0);
        let length_mm = (shortest.m_to_mm() / unit).floor() * unit;
        let rounded: f64 = format!("{length_mm:.6}").parse().unwrap_or(length_mm);
        self.window_length_mm = Some(rounded);
        self.notes.push(format!(
            "the lengths differ: windows of {rounded} mm are cut (window_length_mm)"
        ));
        rounded.mm_to_m()
    }

    fn fit(&mut self, spacing: f64, length: f64) {
        let least_mm = (POINTS_ON_SHORTEST * spacing).m_to_mm();
        let longest_mm = length.m_to_mm() / LENGTHS_IN_SCAN;
        let few = longest_mm / 2.0_f64.powi(FEWEST_WAVES - 1);
        while self.shortest_wavelength_mm > few && self.shortest_wavelength_mm / 2.0 >= least_mm {
            self.shortest_wavelength_mm /= 2.0;
        }
        while self.shortest_wavelength_mm < least_mm {
            self.shortest_wavelength_mm *= 2.0;
        }
        // Round-off must not cost a wave.
        let octaves = ((longest_mm / self.shortest_wavelength_mm).log2() + 1e-9).floor();
        self.waves = (octaves + 1.0).clamp(1.0, 12.0) as u32;
        if least_mm < self.shortest_wavelength_mm * (1.0 - 1e-6) {
            self.lateral_resolution_um =
                Some((RESOLUTION * self.shortest_wavelength_mm).mm_to_um());
        }
    }
}

/// The smallest and the largest.
fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((low.min(value), high.max(value))),
    })
}
