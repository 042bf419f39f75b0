//! multilevel: the average at finite deformation from many realisations on the half-space and few with
//! all waves at finite deformation.
//!
//! Two-level Monte Carlo (Giles, Acta Numerica 24, 2015, doi:10.1017/S096249291500001X; as a control
//! variate of unit coefficient Peherstorfer, Willcox & Gunzburger, SIAM Review 60, 2018,
//! doi:10.1137/16M1082469): the mean of the half-space plus the mean difference of pairs that share
//! their phases (`estimate`). The numbers of both follow from variances and costs (`shares`).
//!
//! | module | what it holds |
//! |---|---|
//! | `bound` | a bound of the difference between half-space and finite deformation on gentle surfaces, where no finite elements are needed to know that the difference is small |
//! | `ensemble` | the realisations of one approximation at one speed under both models |
//! | `estimate` | the two-level estimate of a mean, its confidence interval, and what the interval will be for other numbers of realisations |
//! | `rows` | what the stage writes |
//! | `shares` | how many realisations of each model give the wanted interval for the least work |
//! | `work` | the curves of all ensembles: those that are missing, solved side by side |

mod bound;
mod ensemble;
mod estimate;
mod rows;
mod shares;
mod work;

use super::bem::{Bem, CURVES, CurveRow, SOLVES, SolveRow, Wanted};
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::fem::{Fem, Sweep};
use super::realise::{SURFACES, Surface, read_surfaces};
use super::{Stage, StageError, Watch};
use crate::artifact::{RunView, SolveStore};
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::RubberModel;
use crate::stages::realise::Method;
pub(crate) use bound::is_negligible;
use ensemble::Ensemble;
pub use estimate::Estimate;
pub use rows::{AVERAGES, AverageRow, FURTHER, PAIRS, PairRow, SOLVES as FEM_SOLVES, schemas};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
pub use work::Missing;
use work::Work;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 4;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "multilevel",
    summary: "Averages at finite deformation from many realisations on the half-space and few with all waves",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    let (multilevel, bem, rubber) = (chain.multilevel?, chain.bem, request.rubber());
    let parameters = json!({ "multilevel": multilevel, "bem": bem.resolved(&request.material) });
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(multilevel, bem, rubber, &inputs.results, &inputs.store()?, context)
    };
    Some(Planned::new(parameters, run).reading(SURFACES).reading(CURVES).reading(SOLVES))
}

/// Section `[multilevel]` of a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Multilevel {
    /// Elements on the shortest wave, as in `[fem]`.
    pub columns_per_shortest_wavelength: u32,
    /// Ratio of neighbouring pressures that are solved with finite elements, as in `[fem]`.
    pub pressure_ratio: f64,
    /// Whether the finite-element curves are solved on half the columns too, for the error by the
    /// mesh. Set by the key `tolerance` of the recipe.
    pub estimate_mesh_error: bool,
    /// Realisations solved under both models first; the spread of their differences says how many
    /// more a `tolerance` needs. Without a `tolerance` all that are solved.
    pub first_realisations: u32,
    /// Most realisations solved with finite elements.
    pub most_realisations: u32,
}

impl Default for Multilevel {
    fn default() -> Self {
        let fem = Fem::default();
        Self {
            columns_per_shortest_wavelength: fem.columns_per_shortest_wavelength,
            pressure_ratio: fem.pressure_ratio,
            estimate_mesh_error: fem.estimate_mesh_error,
            first_realisations: 5,
            most_realisations: 30,
        }
    }
}

impl Multilevel {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        let columns = self.columns_per_shortest_wavelength;
        let key = "multilevel.columns_per_shortest_wavelength";
        require((16..=1024).contains(&columns), key, columns, "16 to 1024")?;
        let (key, ratio) = ("multilevel.pressure_ratio", self.pressure_ratio);
        require((1.01..=2.0).contains(&ratio), key, ratio, "between 1.01 and 2")?;
        // The spread of fewer than three differences has an interval too wide for any use.
        let (key, first) = ("multilevel.first_realisations", self.first_realisations);
        require((3..=1000).contains(&first), key, first, "3 to 1000")?;
        let (key, most) = ("multilevel.most_realisations", self.most_realisations);
        let range = "multilevel.first_realisations (5 if not set) to 1000";
        require((first..=1000).contains(&most), key, most, range)
    }

    /// How the curves of all waves at finite deformation are solved.
    pub fn fem(&self) -> Fem {
        Fem {
            waves: Vec::new(),
            methods: Vec::new(),
            columns_per_shortest_wavelength: self.columns_per_shortest_wavelength,
            pressure_ratio: self.pressure_ratio,
            estimate_mesh_error: self.estimate_mesh_error,
        }
    }

    /// The same with the areas of the half-space.
    pub(crate) fn sweep(&self, bem: &Bem) -> Sweep {
        Sweep { fem: self.fem(), wanted: areas_alone(bem) }
    }
}

/// The stage averages at contact areas alone.
fn areas_alone(bem: &Bem) -> Wanted {
    Wanted { pressures_mpa: Vec::new(), ..bem.wanted() }
}

/// Solves what is not in the store and writes the results; returns warnings.
///
/// Curves run side by side; which ones are solved follows from the curves and not from the clock, so
/// that the numbers do not depend on the number of threads or on interruptions.
///
/// # Errors
/// [`StageError::FiniteDeformation`] and [`StageError::Contact`] for a curve that cannot be solved;
/// [`StageError::Interrupted`]. Solves that are done are kept in the store.
pub fn run(
    parameters: &Multilevel,
    bem: &Bem,
    rubber: &RubberModel,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_surfaces(run)?;
    let half_space = HalfSpace::read(run)?;
    let mut ensembles = ensembles(parameters, bem, &surfaces, &half_space);
    let work = Work::new(parameters, bem, rubber, store, context.watch);
    work.solve_all(&mut ensembles)?;
    let averages: Vec<AverageRow> = ensembles.iter().flat_map(Ensemble::averages).collect();
    context.pending.write_rows(AVERAGES, &averages)?;
    let pairs: Vec<PairRow> = ensembles.iter().flat_map(Ensemble::pairs).collect();
    context.pending.write_rows(PAIRS, &pairs)?;
    let further: Vec<CurveRow> = ensembles.iter().flat_map(Ensemble::further).cloned().collect();
    context.pending.write_rows(FURTHER, &further)?;
    let solves: Vec<_> = ensembles.iter().flat_map(Ensemble::solves).cloned().collect();
    context.pending.write_rows(FEM_SOLVES, &solves)?;
    Ok(ensembles.iter().flat_map(Ensemble::warnings).collect())
}

/// What is to be solved next and is not in a packed store; nothing if it has all.
///
/// # Errors
/// As [`run`].
pub fn missing(
    parameters: &Multilevel,
    bem: &Bem,
    rubber: &RubberModel,
    run: &RunView,
    store: &SolveStore,
    watch: Watch,
) -> Result<Missing, StageError> {
    let surfaces = read_surfaces(run)?;
    let half_space = HalfSpace::read(run)?;
    let mut ensembles = ensembles(parameters, bem, &surfaces, &half_space);
    Work::new(parameters, bem, rubber, store, watch).missing(&mut ensembles)
}

/// The results of the half-space.
struct HalfSpace {
    curves: Vec<CurveRow>,
    solves: Vec<SolveRow>,
}

impl HalfSpace {
    fn read(run: &RunView) -> Result<Self, StageError> {
        Ok(Self { curves: run.rows(CURVES)?, solves: run.rows(SOLVES)? })
    }
}

fn ensembles<'a>(
    parameters: &Multilevel,
    bem: &'a Bem,
    surfaces: &'a [Surface],
    half_space: &HalfSpace,
) -> Vec<Ensemble<'a>> {
    surfaces
        .chunk_by(|a, b| a.kind == b.kind)
        .filter(|of_one| of_one[0].kind.method == Method::Sines)
        .flat_map(|of_one| {
            let speeds = bem.speeds_mm_s.iter();
            speeds.map(move |speed| Ensemble::new(parameters, bem, of_one, *speed, half_space))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_out_of_range_is_refused_with_its_key() {
        let refused = |change: fn(&mut Multilevel)| {
            let mut section = Multilevel::default();
            section.check().unwrap();
            change(&mut section);
            section.check().unwrap_err().to_string()
        };
        let few = refused(|section| section.first_realisations = 2);
        assert!(few.contains("multilevel.first_realisations"), "{few}");
        let less = refused(|section| section.most_realisations = 4);
        assert!(less.contains("multilevel.most_realisations"), "{less}");
        let ratio = refused(|section| section.pressure_ratio = 1.0);
        assert!(ratio.contains("multilevel.pressure_ratio"), "{ratio}");
        let mesh = refused(|section| section.columns_per_shortest_wavelength = 8);
        assert!(mesh.contains("multilevel.columns_per_shortest_wavelength"), "{mesh}");
    }
}
