//! The recipe: a TOML file that says what a run does, with units in its keys.
//!
//! | module | what it holds |
//! |---|---|
//! | `error` | what can be wrong with a recipe |
//! | `hints` | where a mistake stands in a recipe, and what was typed there |
//! | `sweep` | section `[sweep]`: lists in place of single values, and the cases that they make |
//! | `validation` | section `[validation]`: measured friction that the recipe is held against |

mod error;
mod hints;
mod sweep;
mod validation;

pub use error::RecipeError;
pub use sweep::{Case, Specimen, Sweep};
pub use validation::{Spectrum, Stress, Validation};

use crate::contact::refine::{TOLERANCES, TOLERANCES_IN_WORDS};
use crate::files::{self, TomlError};
use crate::requirement::{InvalidRecipe, require};
use crate::stages::{
    Chain, Job,
    approximate::Approximate,
    areal::Areal,
    bem::Bem,
    characterise::Characterise,
    feedback::Feedback,
    fem::Fem,
    hybrid::Hybrid,
    ingest::Ingest,
    methods::Methods,
    micro::Micro,
    multilevel::Multilevel,
    realise::{MOST_REALISATIONS, Realise},
    sinusoid::Sinusoid,
    tables::{Adhesion, Tables},
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A recipe. Paths in it are relative to the folder of its file; unknown keys are refused.
///
/// Either the sections from scans to tables, with or without `[sweep]`, or `[sinusoid]` alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// What the run is about, in one line.
    pub title: String,
    /// Wanted relative accuracy of the averaged friction, between 1e-8 and 0.5. A quarter each may go to
    /// the grids (`bem.grid_tolerance`) and to interpolation (`bem.tolerance`, `micro.tolerance`), an eighth
    /// to waves that are left out; realisations are solved until their statistical error fits into the
    /// rest (`bem.average_tolerance`), up to `realise.most_realisations`. The recipe leaves the keys of `bem`
    /// out then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Line scans and how to read and condition them. Without this section the waves must stand
    /// in `approximate.given`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ingest: Option<Ingest>,
    /// Roughness parameters, height-difference correlation, spectrum, self-affine fit.
    #[serde(default)]
    pub characterise: Characterise,
    /// Superposed sines in place of the scans.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approximate: Option<Approximate>,
    /// Random-phase realisations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub realise: Option<Realise>,
    /// Sliding contact of the viscoelastic half-space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bem: Option<Bem>,
    /// Sliding contact of areal surfaces, where maps are kept or isotropic surfaces are made.
    #[serde(default, skip_serializing_if = "is_default")]
    pub areal: Areal,
    /// Contacts with their own heat and strain, beside those of `bem`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feedback: Option<Feedback>,
    /// The steepest waves at finite deformation; with it, friction is corrected by them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub micro: Option<Micro>,
    /// How friction is corrected; only with `[micro]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hybrid: Option<Hybrid>,
    /// All waves at finite deformation, for small surfaces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fem: Option<Fem>,
    /// Averages at finite deformation from many realisations on the half-space and few with all waves
    /// at finite deformation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multilevel: Option<Multilevel>,
    /// Averaged friction tables.
    #[serde(default)]
    pub tables: Tables,
    /// The older multiscale methods beside the models of the tables.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub methods: Option<Methods>,
    /// Shear stress of the contact area; with it, the tables have the total friction beside the hysteresis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adhesion: Option<Adhesion>,
    /// Measured friction, for `asperity validate`; no stage reads it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub validation: Option<Validation>,
    /// The study of one sine wave under three models, in place of all other sections.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sinusoid: Option<Sinusoid>,
    /// Lists of specimens, rubbers, temperatures and seeds: a case for every combination.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Sweep>,
}

impl Recipe {
    /// Reads and checks a recipe; paths in it become relative to the working folder.
    ///
    /// # Errors
    /// [`RecipeError`], which names the file and the key.
    pub fn read(path: &Path) -> Result<Self, RecipeError> {
        let text = files::read_settings(path)
            .map_err(|source| RecipeError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, path)
    }

    /// The recipe in a text; `path` is where it stands, for messages and relative paths.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, RecipeError> {
        let mut recipe: Self = toml::from_str(text).map_err(|error| RecipeError::Parse {
            path: path.to_owned(),
            problem: TomlError::new(text, &error),
            is_rubber: text.contains("equilibrium_modulus_mpa"),
        })?;
        recipe.share_tolerance().and_then(|()| recipe.check()).map_err(|violation| {
            let (line, typed) = hints::place(text, &violation);
            RecipeError::Value {
                path: path.to_owned(),
                line,
                typed,
                violation: Box::new(violation),
            }
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        for path in recipe.paths_mut() {
            *path = folder.join(&*path);
        }
        Ok(recipe)
    }

    /// Hands the wanted accuracy to the stages, unless some of them have one of their own.
    fn share_tolerance(&mut self) -> Result<(), InvalidRecipe> {
        let Some(tolerance) = self.tolerance else { return Ok(()) };
        let own = self.bem.as_ref().is_some_and(|bem| {
            [bem.tolerance, bem.grid_tolerance, bem.average_tolerance].iter().any(Option::is_some)
        });
        let alone = "given alone: leave out bem.tolerance, bem.grid_tolerance and bem.average_tolerance, which follow from it";
        require(!own, "tolerance", tolerance, alone)?;
        self.set_tolerance(tolerance)
    }

    /// Asks for a relative accuracy of the averaged friction, whatever the recipe asks for.
    ///
    /// # Errors
    /// [`InvalidRecipe::Value`] for one outside [`TOLERANCES`], and for the study of one sine.
    pub fn set_tolerance(&mut self, tolerance: f64) -> Result<(), InvalidRecipe> {
        require(TOLERANCES.contains(&tolerance), "tolerance", tolerance, TOLERANCES_IN_WORDS)?;
        let chain = self.sinusoid.is_none();
        require(
            chain,
            "tolerance",
            tolerance,
            "left out beside [sinusoid], whose solves have keys of their own",
        )?;
        let share = tolerance / 4.0;
        if let Some(bem) = &mut self.bem {
            (bem.tolerance, bem.grid_tolerance) = (Some(share), Some(share));
            bem.average_tolerance = Some(tolerance);
        }
        if let Some(realise) = &mut self.realise {
            realise.most_realisations.get_or_insert(MOST_REALISATIONS);
        }
        if let Some(micro) = &mut self.micro {
            (micro.tolerance, micro.estimate_mesh_error) = (share, true);
        }
        if let Some(fem) = &mut self.fem {
            fem.estimate_mesh_error = true;
        }
        if let Some(multilevel) = &mut self.multilevel {
            multilevel.estimate_mesh_error = true;
        }
        self.tables.tolerance = Some(tolerance);
        self.tolerance = Some(tolerance);
        Ok(())
    }

    /// The recipe as a text that [`Recipe::parse`] reads back to the same.
    ///
    /// # Errors
    /// What has no form in TOML, in words.
    pub fn to_toml(&self) -> Result<String, String> {
        let mut written = self.clone();
        if self.tolerance.is_some()
            && let Some(bem) = &mut written.bem
        {
            // They follow from it and must not stand beside it.
            (bem.tolerance, bem.grid_tolerance, bem.average_tolerance) = (None, None, None);
        }
        toml::to_string(&written).map_err(|error| error.to_string())
    }

    /// The same with all paths absolute, for a recipe that is read elsewhere.
    ///
    /// # Errors
    /// The operating system's, if the working folder is not known.
    pub fn absolute(mut self) -> std::io::Result<Self> {
        for path in self.paths_mut() {
            *path = std::path::absolute(&*path)?;
        }
        Ok(self)
    }

    /// Every file and folder that the recipe names.
    pub fn files(&self) -> Vec<PathBuf> {
        self.clone().paths_mut().map(|path| path.clone()).collect()
    }

    /// Every file that the recipe names.
    fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let Self { ingest, bem, sinusoid, tables, sweep, validation, .. } = self;
        let corrections = tables.published_corrections.iter_mut().map(|table| &mut table.file);
        ingest
            .iter_mut()
            .flat_map(|ingest| &mut ingest.scans)
            .chain(bem.iter_mut().map(|bem| &mut bem.rubber))
            .chain(sinusoid.iter_mut().map(|sinusoid| &mut sinusoid.rubber))
            .chain(tables.published.iter_mut().map(|table| &mut table.file))
            .chain(corrections)
            .chain(sweep.iter_mut().flat_map(Sweep::paths_mut))
            .chain(validation.iter_mut().flat_map(Validation::paths_mut))
            // A rubber may be left to the sweep.
            .filter(|path| !path.as_os_str().is_empty())
    }

    /// What the recipe asks for.
    ///
    /// # Errors
    /// [`InvalidRecipe::MissingSection`], [`InvalidRecipe::SectionBesideSinusoid`],
    /// [`InvalidRecipe::SeveralCases`].
    pub fn job(&self) -> Result<Job<'_>, InvalidRecipe> {
        if self.sweep.is_some() && self.sinusoid.is_none() {
            return Err(InvalidRecipe::SeveralCases { cases: self.cases()?.len() });
        }
        let Some(sinusoid) = &self.sinusoid else {
            return self.chain().map(Job::Chain);
        };
        let others = [
            ("ingest", self.ingest.is_some()),
            ("characterise", self.characterise != Characterise::default()),
            ("approximate", self.approximate.is_some()),
            ("realise", self.realise.is_some()),
            ("bem", self.bem.is_some()),
            ("areal", self.areal != Areal::default()),
            ("feedback", self.feedback.is_some()),
            ("micro", self.micro.is_some()),
            ("hybrid", self.hybrid.is_some()),
            ("fem", self.fem.is_some()),
            ("multilevel", self.multilevel.is_some()),
            ("tables", self.tables != Tables::default()),
            ("methods", self.methods.is_some()),
            ("adhesion", self.adhesion.is_some()),
            ("validation", self.validation.is_some()),
            ("sweep", self.sweep.is_some()),
        ];
        match others.into_iter().find(|(_, present)| *present) {
            Some((section, _)) => Err(InvalidRecipe::SectionBesideSinusoid { section }),
            None => Ok(Job::Sinusoid(sinusoid)),
        }
    }

    fn chain(&self) -> Result<Chain<'_>, InvalidRecipe> {
        let missing = |section| InvalidRecipe::MissingSection { section };
        if self.is_spectrum_alone() {
            return Err(InvalidRecipe::SpectrumAlone);
        }
        if self.hybrid.is_some() && self.micro.is_none() {
            return Err(InvalidRecipe::HybridWithoutMicro);
        }
        Ok(Chain {
            ingest: self.ingest.as_ref(),
            characterise: &self.characterise,
            approximate: self.approximate.as_ref().ok_or(missing("approximate"))?,
            realise: self.realise.as_ref().ok_or(missing("realise"))?,
            bem: self.bem.as_ref().ok_or(missing("bem"))?,
            areal: &self.areal,
            feedback: self.feedback.as_ref(),
            micro: self.micro.as_ref(),
            hybrid: self.hybrid.unwrap_or_default(),
            fem: self.fem.as_ref(),
            multilevel: self.multilevel.as_ref(),
            tables: &self.tables,
            methods: self.methods.as_ref(),
            adhesion: self.adhesion.as_ref(),
        })
    }

    fn check(&self) -> Result<(), InvalidRecipe> {
        self.check_sweep()?;
        if self.sweep.is_some() && self.sinusoid.is_none() {
            // All cases are checked by what they have in common.
            return self.cases()?.first().map_or(Ok(()), |case| case.recipe.check());
        }
        if let (Some(validation), Some(bem)) = (&self.validation, &self.bem) {
            validation.check(&bem.pressures_mpa)?;
            if self.is_spectrum_alone() {
                return bem.check();
            }
        }
        match self.job()? {
            Job::Chain(chain) => chain.check(),
            Job::Sinusoid(sinusoid) => sinusoid.check(),
        }
    }

    /// Whether the recipe has a spectrum for `asperity validate` in place of scans or waves, and no stage to run.
    pub fn is_spectrum_alone(&self) -> bool {
        let spectrum = self.validation.as_ref().is_some_and(|own| own.spectrum.is_some());
        spectrum && self.ingest.is_none() && self.approximate.is_none() && self.realise.is_none()
    }
}

fn is_default(areal: &Areal) -> bool {
    *areal == Areal::default()
}

impl Chain<'_> {
    /// Checks that areal surfaces and what is said about them go together.
    fn check_areal(&self) -> Result<(), InvalidRecipe> {
        let has_maps = self.has_maps() && self.realise.names_windows();
        let wanted =
            "left out unless [ingest.maps] keeps maps and realise.methods has surfaces of windows";
        require(self.realise.profiles || has_maps, "realise.profiles", false, wanted)?;
        let count = self.realise.areal_realisations.unwrap_or(0);
        let wanted =
            "left out without areal surfaces (a section [ingest.maps], or the method isotropic)";
        let areal = self.has_areal_surfaces();
        require(areal || count == 0, "realise.areal_realisations", count, wanted)?;
        require(areal || is_default(self.areal), "areal", "a section", wanted)?;
        let finite = [
            ("micro", self.micro.is_some()),
            ("fem", self.fem.is_some()),
            ("multilevel", self.multilevel.is_some()),
        ];
        let has_lines = self.realise.has_windows() || !self.realise.waves.is_empty();
        let wanted = "left out where no profile is made: finite deformation is for profiles";
        for (key, given) in finite {
            require(has_lines || !given, key, "a section", wanted)?;
        }
        let wanted = "left out where no profile is made: heat and softening are for profiles";
        require(has_lines || self.feedback.is_none(), "feedback", "a section", wanted)
    }

    fn check(&self) -> Result<(), InvalidRecipe> {
        self.ingest.map_or(Ok(()), Ingest::check)?;
        self.characterise.check()?;
        self.approximate.check()?;
        self.realise.check()?;
        self.bem.check()?;
        self.areal.check(self.bem)?;
        self.check_areal()?;
        self.micro.map_or(Ok(()), Micro::check)?;
        self.fem.map_or(Ok(()), Fem::check)?;
        self.multilevel.map_or(Ok(()), Multilevel::check)?;
        self.tables.check()?;
        self.methods.map_or(Ok(()), |methods| methods.check(&self.realise.waves))?;
        self.adhesion.map_or(Ok(()), |adhesion| {
            adhesion.check(self.bem.temperature_c, &self.bem.speeds_mm_s)
        })?;
        if let Some(feedback) = self.feedback {
            // A law that is none was refused by the check before.
            let shear = self.adhesion.and_then(|adhesion| adhesion.shear_law().ok());
            feedback.check(self.bem, &self.realise.methods, shear.as_ref())?;
        }
        let limit = self.realise.most_realisations.unwrap_or(0);
        require(
            limit == 0 || self.bem.average_tolerance.is_some(),
            "realise.most_realisations",
            limit,
            "left out without `tolerance`, which it limits: set realise.realisations",
        )?;
        let (scans, given) = (self.ingest.is_some(), !self.approximate.given.is_empty());
        require(
            scans != given && (!given || self.approximate.waves.is_empty()),
            "approximate.given",
            self.approximate.given.len(),
            "given without [ingest] and approximate.waves, or left out with both",
        )?;
        if let Some(fem) = self.fem {
            require(
                fem.waves.iter().all(|waves| self.realise.waves.contains(waves)),
                "fem.waves",
                &fem.waves,
                "numbers of waves that also stand in realise.waves",
            )?;
        }
        if let Some(published) = self.tables.published_corrections.first() {
            require(
                self.micro.is_some(),
                "tables.published_corrections",
                &published.name,
                "left out without a section [micro], whose samples stand beside them",
            )?;
        }
        let fitted = self.approximate.numbers();
        require(
            scans || !(self.realise.names_windows() || self.realise.is_isotropic()),
            "realise.methods",
            self.realise.methods.iter().map(|method| method.name()).collect::<Vec<_>>(),
            "sines alone where the recipe states the waves and has no scans",
        )?;
        require(
            self.realise.waves.iter().all(|waves| fitted.contains(waves)),
            "realise.waves",
            &self.realise.waves,
            "numbers of waves that also stand in approximate.waves",
        )
    }
}
