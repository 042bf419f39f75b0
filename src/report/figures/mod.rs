//! The figures of a run, each made of its results alone.
//!
//! | module | what it holds |
//! |---|---|
//! | `accuracy` | what accuracy costs, and what the error is made of |
//! | `along` | friction over speed, or over contact area or pressure, in panels and curves |
//! | `budget` | what the error of friction is made of |
//! | `contact` | contact area over pressure |
//! | `correction` | the correction of the half-space by the microscale |
//! | `direction` | friction of areal surfaces over the direction of sliding |
//! | `effects` | friction with the heat and the strain of the contact, and without |
//! | `fields` | pressure and deformation along a surface |
//! | `friction` | friction over contact area |
//! | `maps` | contact pressure and contact patches of areal surfaces |
//! | `methods` | friction of one road under the surfaces that stand for it |
//! | `patches` | contact patches of a periodic map |
//! | `roughness` | correlation and spectrum of the scans |
//! | `rubber` | the master curve of the rubber of a run |
//! | `rubber_fit` | measured and fitted moduli over frequency, and the shift factors |
//! | `scans` | what the scans look like |
//! | `speed` | friction over speed |
//! | `study` | friction and contact area of the study of one sine wave |
//! | `total` | hysteresis, the shear of the contact area, and their sum |
//! | `waves` | the superposed sines |

mod accuracy;
mod along;
mod budget;
mod contact;
mod correction;
mod direction;
mod effects;
mod fields;
mod friction;
mod maps;
mod methods;
mod patches;
mod roughness;
mod rubber;
mod rubber_fit;
mod scans;
mod speed;
mod study;
mod total;
mod waves;

pub use friction::friction_figure;
pub(super) use methods::reference;
pub(super) use rubber::{Material, material};
pub use rubber_fit::rubber_fit_figure;
pub use speed::speed_figure;
pub use study::study_figure;
pub(super) use waves::microscale_slope;

use super::About;
use super::ReportError;
use super::tables::significant;
use crate::artifact::RunView;
use crate::plot::Figure;
use crate::stages;
use crate::stages::Stage;
use crate::stages::realise::SurfaceKind;
use crate::stages::tables::FrictionRow;

/// A kind of figure.
#[derive(Debug)]
pub struct Kind {
    /// Name on the command line.
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// What a run must have for it.
    pub requires: &'static str,
    /// The stages whose results it shows.
    pub stages: &'static [Stage],
    make: fn(&RunView) -> Result<Option<Figure>, ReportError>,
}

/// All kinds of figures, in the order of the data.
pub static ALL: [Kind; 21] = [
    Kind {
        name: "scans",
        shows: "heights of some windows over their length",
        requires: "scans, section [ingest]",
        stages: &[stages::ingest::STAGE],
        make: scans::scans,
    },
    Kind {
        name: "heights",
        shows: "distribution of the heights of all windows",
        requires: "scans, section [ingest]",
        stages: &[stages::ingest::STAGE],
        make: scans::heights,
    },
    Kind {
        name: "correlation",
        shows: "height-difference correlation of the scans and of the superposed sines",
        requires: "scans, section [ingest]",
        stages: &[stages::characterise::STAGE, stages::approximate::STAGE],
        make: roughness::correlation,
    },
    Kind {
        name: "spectrum",
        shows: "power spectral density with its standard error",
        requires: "scans, section [ingest]",
        stages: &[stages::characterise::STAGE],
        make: roughness::spectrum,
    },
    Kind {
        name: "waves",
        shows: "amplitudes and root mean square slopes of the superposed sines",
        requires: "the stage approximate",
        stages: &[stages::approximate::STAGE, stages::micro::STAGE],
        make: waves::waves,
    },
    Kind {
        name: "friction",
        shows: "friction over contact area, all models, with the band over realisations",
        requires: "the stage tables",
        stages: &[stages::tables::STAGE],
        make: friction::friction,
    },
    Kind {
        name: "methods",
        shows: "friction of the same road under all surfaces that stand for it, with the ratio to the measured profiles or maps",
        requires: "measured profiles or maps, and other surfaces, key realise.methods",
        stages: &[stages::tables::STAGE],
        make: methods::methods,
    },
    Kind {
        name: "speed",
        shows: "friction over sliding speed, of sweeps a line for each case",
        requires: "two or more speeds, key bem.speeds_mm_s",
        stages: &[stages::tables::STAGE],
        make: speed::speed,
    },
    Kind {
        name: "total",
        shows: "hysteretic, adhesive and total friction over speed, or over contact area or pressure",
        requires: "the shear stress of the contact area, section [adhesion]",
        stages: &[stages::tables::STAGE],
        make: total::total,
    },
    Kind {
        name: "effects",
        shows: "friction cold, softened by strain, hot, and both, over speed or pressure",
        requires: "heat or softening of the contact, section [feedback]",
        stages: &[stages::feedback::STAGE, stages::tables::STAGE],
        make: effects::effects,
    },
    Kind {
        name: "budget",
        shows: "what the error of friction is made of, over contact area or pressure",
        requires: "the stage tables",
        stages: &[stages::tables::STAGE],
        make: budget::budget,
    },
    Kind {
        name: "comparison",
        shows: "computed beside published friction",
        requires: "published tables, key tables.published",
        stages: &[stages::tables::STAGE],
        make: friction::comparison,
    },
    Kind {
        name: "area",
        shows: "contact area over pressure of every solved contact",
        requires: "the stage bem",
        stages: &[stages::bem::STAGE, stages::areal::STAGE],
        make: contact::area,
    },
    Kind {
        name: "correction",
        shows: "friction of the microscale under both models and the correction, over pressure",
        requires: "a microscale: section [micro], and waves that are steep enough",
        stages: &[stages::micro::STAGE, stages::hybrid::STAGE],
        make: correction::correction,
    },
    Kind {
        name: "pressure",
        shows: "contact pressure along the surface",
        requires: "fields, key bem.field_area_fractions",
        stages: &[stages::bem::STAGE],
        make: fields::pressure,
    },
    Kind {
        name: "deformation",
        shows: "profile and deformed rubber along the surface",
        requires: "fields, key bem.field_area_fractions",
        stages: &[stages::realise::STAGE, stages::bem::STAGE],
        make: fields::deformation,
    },
    Kind {
        name: "pressure-map",
        shows: "contact pressure and contact patches of an areal surface, in colours",
        requires: "fields of areal surfaces: height maps, section [ingest.maps], and key areal.field_area_fractions",
        stages: &[stages::realise::STAGE, stages::areal::STAGE],
        make: maps::pressure_map,
    },
    Kind {
        name: "direction",
        shows: "friction of areal surfaces over the direction of sliding",
        requires: "areal surfaces and two or more directions, key areal.angles_deg",
        stages: &[stages::areal::STAGE],
        make: direction::direction,
    },
    Kind {
        name: "rubber",
        shows: "moduli and loss factor over frequency with the frequencies that the surface excites",
        requires: "the stage bem",
        stages: &[stages::realise::STAGE, stages::bem::STAGE],
        make: rubber::rubber,
    },
    Kind {
        name: "accuracy",
        shows: "seconds against estimated error of every contact, and the parts of the error",
        requires: "the stage bem",
        stages: &[
            stages::bem::STAGE,
            stages::areal::STAGE,
            stages::micro::STAGE,
            stages::fem::STAGE,
            stages::multilevel::STAGE,
            stages::tables::STAGE,
        ],
        make: accuracy::accuracy,
    },
    Kind {
        name: "study",
        shows: "friction and contact area of one sine over speed under three models",
        requires: "the study of one sine, section [sinusoid]",
        stages: &[stages::sinusoid::STAGE],
        make: study::study,
    },
];

impl Kind {
    /// The kind of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|kind| kind.name == name)
    }

    /// The figure of a run; `None` if the run has no such results.
    ///
    /// # Errors
    /// [`ReportError`] if results cannot be read.
    pub fn figure(&self, run: &RunView) -> Result<Option<Figure>, ReportError> {
        (self.make)(run)
    }
}

/// At most about twice `stretches` points that look alike: the lowest and the highest of each stretch.
fn thinned(points: &[(f64, f64)], stretches: usize) -> Vec<(f64, f64)> {
    let stretch = points.len().div_ceil(stretches.max(1));
    if stretch <= 2 {
        return points.to_vec();
    }
    let ends = |points: &[(f64, f64)]| {
        let valid = || points.iter().enumerate().filter(|(_, point)| !point.1.is_nan());
        let low = valid().min_by(|a, b| a.1.1.total_cmp(&b.1.1));
        let high = valid().max_by(|a, b| a.1.1.total_cmp(&b.1.1));
        match (low, high) {
            (Some((i, low)), Some((k, high))) if i < k => vec![*low, *high],
            (Some((_, low)), Some((_, high))) => vec![*high, *low],
            _ => vec![points[0]],
        }
    };
    points.chunks(stretch).flat_map(ends).collect()
}

/// The rows of a table by key, in the order of the keys.
fn grouped<R, K: Ord>(rows: &[R], key: impl Fn(&R) -> K) -> std::collections::BTreeMap<K, Vec<&R>> {
    let mut groups = std::collections::BTreeMap::<K, Vec<&R>>::new();
    for row in rows {
        groups.entry(key(row)).or_default().push(row);
    }
    groups
}

/// A speed as a key: its bits sort like itself, since speeds are positive.
fn speed_key(speed_mm_s: f64) -> u64 {
    speed_mm_s.to_bits()
}

/// What a table is of, for headings.
fn heading(kind: SurfaceKind, speed_mm_s: f64) -> String {
    format!("{kind}, {speed_mm_s} mm/s")
}

/// Heading of a friction table with its shortest wavelength and rubber, on which friction depends.
fn full_heading(row: &FrictionRow, about: &About) -> String {
    let shortest = significant(row.shortest_wavelength_mm);
    format!("{} from {shortest} mm, {} mm/s, {}", row.kind, row.speed_mm_s, about.material())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        let names: std::collections::BTreeSet<_> = ALL.iter().map(|kind| kind.name).collect();
        assert_eq!(names.len(), ALL.len());
    }

    #[test]
    fn thinning_keeps_the_extremes_and_the_gaps() {
        let mut points: Vec<(f64, f64)> =
            (0..10_000).map(|i| (f64::from(i), (f64::from(i) * 0.7).sin())).collect();
        points[5123].1 = 9.0;
        points[7007].1 = -9.0;
        points[2000..2200].iter_mut().for_each(|point| point.1 = f64::NAN);
        let few = thinned(&points, 500);
        assert!(few.len() <= 1000);
        assert!(few.contains(&(5123.0, 9.0)) && few.contains(&(7007.0, -9.0)));
        assert!(few.iter().any(|point| point.1.is_nan()));
        assert!(few.is_sorted_by(|a, b| a.0 <= b.0));
    }
}
