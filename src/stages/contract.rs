//! What a stage is: one value of [`Contract`] in its file. The pipeline, the command line and the report know no more of
//! it, so that a stage is added by its file and its place in [`Stage::ALL`].

use super::approximate::Approximate;
use super::areal::Areal;
use super::bem::Bem;
use super::characterise::Characterise;
use super::feedback::Feedback;
use super::fem::Fem;
use super::hybrid::Hybrid;
use super::ingest::{Ingest, ScanFile};
use super::methods::Methods;
use super::micro::Micro;
use super::multilevel::Multilevel;
use super::realise::Realise;
use super::sinusoid::Sinusoid;
use super::tables::{Adhesion, Tables};
use super::{Stage, StageError, Watch};
use crate::artifact::{
    ArtifactError, Input, Pending, ResultFile, RunView, SOLVES_FOLDER, SchemaVersion, SolveStore,
};
use crate::rubber::{Rubber, RubberData, RubberModel};
use serde_json::Value;

/// A stage: its name, what of the code determines its result, and what it does for a recipe.
pub struct Contract {
    /// Name in recipes, folders and manifests.
    pub name: &'static str,
    /// What it does, in a line of the help.
    pub summary: &'static str,
    /// Raised when the same parameters give other numbers.
    pub revision: u32,
    /// Schemas of the results.
    pub schemas: fn() -> Vec<SchemaVersion>,
    /// What it does for a recipe; `None` if the recipe does not ask for it.
    pub plan: for<'a> fn(&'a Request<'a>) -> Option<Planned<'a>>,
}

/// What a recipe asks for.
#[derive(Debug, Clone, Copy)]
pub enum Job<'a> {
    /// From scans, or waves that it states, to friction tables.
    Chain(Chain<'a>),
    /// The study of one sine wave.
    Sinusoid(&'a Sinusoid),
}

/// The sections of the chain from scans to tables.
#[derive(Debug, Clone, Copy)]
pub struct Chain<'a> {
    /// Section `[ingest]`, if the recipe does not state its waves itself.
    pub ingest: Option<&'a Ingest>,
    /// Section `[characterise]`.
    pub characterise: &'a Characterise,
    /// Section `[approximate]`.
    pub approximate: &'a Approximate,
    /// Section `[realise]`.
    pub realise: &'a Realise,
    /// Section `[bem]`.
    pub bem: &'a Bem,
    /// Section `[areal]`.
    pub areal: &'a Areal,
    /// Section `[feedback]`, if contacts are to be solved with their own heat or strain.
    pub feedback: Option<&'a Feedback>,
    /// Section `[micro]`, if friction is to be corrected.
    pub micro: Option<&'a Micro>,
    /// Section `[hybrid]`.
    pub hybrid: Hybrid,
    /// Section `[fem]`, if all waves are to be solved at finite deformation.
    pub fem: Option<&'a Fem>,
    /// Section `[multilevel]`, if averages at finite deformation are to be estimated.
    pub multilevel: Option<&'a Multilevel>,
    /// Section `[tables]`.
    pub tables: &'a Tables,
    /// Section `[methods]`, if the older multiscale methods are to stand beside the models.
    pub methods: Option<&'a Methods>,
    /// Section `[adhesion]`, if the contact area carries a shear stress.
    pub adhesion: Option<&'a Adhesion>,
}

/// What a recipe asks for, with what it refers to: all that a stage may know besides the results before it.
pub struct Request<'a> {
    /// The sections of the recipe.
    pub job: Job<'a>,
    /// The scans, with their digests.
    pub scans: Vec<ScanFile>,
    /// The rubber at the temperature of the recipe.
    pub material: RubberData,
    /// Published tables, with their digests.
    pub published: Vec<Input>,
}

impl<'a> Request<'a> {
    /// The sections of a recipe alone, to ask which stages it has: no file is read.
    pub fn without_files(job: Job<'a>) -> Self {
        let material = RubberData::from(Rubber::elastic(1.0, 0.49));
        Self { job, scans: Vec::new(), material, published: Vec::new() }
    }

    /// The sections of the chain; `None` for the study of one sine.
    pub fn chain(&self) -> Option<&Chain<'a>> {
        match &self.job {
            Job::Chain(chain) => Some(chain),
            Job::Sinusoid(_) => None,
        }
    }

    /// The rubber.
    pub fn rubber(&self) -> &RubberModel {
        &self.material.rubber
    }
}

/// From the inputs of a stage to its result and warnings.
type Compute<'a> = dyn Fn(&Inputs, &mut Context) -> Result<Vec<String>, StageError> + 'a;

/// A stage for one recipe: all that determines its result, and the function that makes it.
pub struct Planned<'a> {
    /// Files of other stages that it reads; any other read is refused ([`ArtifactError::Undeclared`]).
    pub reads: Vec<ResultFile>,
    /// Parameters, part of the key of the result.
    pub parameters: Value,
    /// Files from outside that it reads, with their digests.
    pub inputs: Vec<Input>,
    compute: Box<Compute<'a>>,
}

impl<'a> Planned<'a> {
    /// A stage that reads nothing.
    pub fn new(
        parameters: Value,
        compute: impl Fn(&Inputs, &mut Context) -> Result<Vec<String>, StageError> + 'a,
    ) -> Self {
        Self { reads: Vec::new(), parameters, inputs: Vec::new(), compute: Box::new(compute) }
    }

    /// With a file of another stage that it reads.
    #[must_use]
    pub fn reading(mut self, file: impl Into<ResultFile>) -> Self {
        self.reads.push(file.into());
        self
    }

    /// The same where the recipe asks for it.
    #[must_use]
    pub fn reading_if(self, asked: bool, file: impl Into<ResultFile>) -> Self {
        if asked { self.reading(file) } else { self }
    }

    /// With files from outside that it reads.
    #[must_use]
    pub fn with_inputs(mut self, inputs: Vec<Input>) -> Self {
        self.inputs = inputs;
        self
    }

    /// Computes the result; returns warnings. `afresh` solves again what the store of single solves has.
    ///
    /// # Errors
    /// [`StageError`].
    pub fn compute(
        &self,
        view: &RunView,
        afresh: bool,
        context: &mut Context,
    ) -> Result<Vec<String>, StageError> {
        let inputs = Inputs { results: view.declaring(self.reads.clone()), afresh };
        (self.compute)(&inputs, context)
    }
}

/// What a stage is given to read.
pub struct Inputs {
    /// The results of other stages, of which it may read what it declares.
    pub results: RunView,
    afresh: bool,
}

impl Inputs {
    /// The store of single solves; a stage that is computed afresh does not find those of before.
    ///
    /// # Errors
    /// Those of the operating system.
    pub fn store(&self) -> Result<SolveStore, ArtifactError> {
        let store = SolveStore::open(self.results.path().join(SOLVES_FOLDER))?;
        Ok(if self.afresh { store.anew() } else { store })
    }
}

/// Where a stage writes its result, and who looks on.
pub struct Context<'a> {
    /// The folder of the result under way.
    pub pending: Pending<'a>,
    /// Who looks on.
    pub watch: Watch<'a>,
}

impl Context<'_> {
    /// Fails if the user has interrupted.
    ///
    /// # Errors
    /// [`StageError::Interrupted`].
    pub fn check_interrupt(&self) -> Result<(), StageError> {
        self.watch.check_interrupt()
    }
}

impl Stage {
    /// Name in recipes, folders and manifests.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// What it does for a recipe; `None` if the recipe does not ask for it.
    pub fn plan<'a>(self, request: &'a Request<'a>) -> Option<Planned<'a>> {
        (self.0.plan)(request)
    }

    /// Its place in the order of the data.
    fn place(self) -> usize {
        let place = Self::ALL.iter().position(|stage| *stage == self);
        place.unwrap_or(Self::ALL.len())
    }
}

impl PartialEq for Stage {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Stage {}

impl PartialOrd for Stage {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// By the order of the data; stages that are in no list of the program come last, by name.
impl Ord for Stage {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.place(), self.name()).cmp(&(other.place(), other.name()))
    }
}

impl std::hash::Hash for Stage {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}

impl std::fmt::Debug for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::fmt::Display for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl serde::Serialize for Stage {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl clap::ValueEnum for Stage {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(clap::builder::PossibleValue::new(self.0.name).help(self.0.summary))
    }
}
