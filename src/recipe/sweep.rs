//! Section `[sweep]`: lists in place of single values, and the cases that they make.

use super::Recipe;
use crate::requirement::{InvalidRecipe, require};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// More cases than this are a mistake in a list.
const MOST_CASES: usize = 1_000_000;

/// Section `[sweep]` of a recipe: every combination of the listed values is a case with tables of its own.
/// What is listed here is left out of its usual place. Speeds are a list anyway (`bem.speeds_mm_s`).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sweep {
    /// Specimens, in place of `ingest.scans`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub specimens: Vec<Specimen>,
    /// Rubber files, in place of `bem.rubber`; tables know them by their file names without extension.
    #[serde(skip_serializing_if = "Vec::is_empty", with = "crate::files::name::paths")]
    #[schemars(with = "Vec<String>")]
    pub rubbers: Vec<PathBuf>,
    /// Temperatures in °C, in place of `bem.temperature_c`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub temperatures_c: Vec<f64>,
    /// Seeds of the random phases, in place of `realise.seed`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub seeds: Vec<u64>,
}

/// A road specimen and its scans.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Specimen {
    /// Its name in tables and folders.
    pub name: String,
    /// Its scan files, and folders of which every file is a scan of it.
    #[serde(with = "crate::files::name::paths")]
    #[schemars(with = "Vec<String>")]
    pub scans: Vec<PathBuf>,
}

/// One combination of the lists of a sweep: a recipe without any list, and what it is known by.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name of the specimen, if specimens are listed.
    pub specimen: Option<String>,
    /// Name of the rubber's file, without extension.
    pub rubber: String,
    /// Temperature in °C to which the rubber is shifted, if it is.
    pub temperature_c: Option<f64>,
    /// Seed of the random phases.
    pub seed: u64,
    /// Folder of its surfaces in that of all surfaces: what specimen and seed determine.
    pub surfaces: PathBuf,
    /// Its folder in that of all cases, such as `specimen=A/rubber=tread/seed=2`.
    pub folder: PathBuf,
    /// The recipe of this case alone.
    pub recipe: Recipe,
}

impl Sweep {
    /// Every file that the section names.
    pub(super) fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let scans = self.specimens.iter_mut().flat_map(|specimen| &mut specimen.scans);
        scans.chain(&mut self.rubbers)
    }

    fn check(&self) -> Result<(), InvalidRecipe> {
        let names: Vec<&str> =
            self.specimens.iter().map(|specimen| specimen.name.as_str()).collect();
        let named = "names of letters, digits, `.`, `_` and `-`, 100 at most, each once: they become folders";
        require(are_names(&names), "sweep.specimens.name", &names, named)?;
        let scans = self.specimens.iter().all(|specimen| !specimen.scans.is_empty());
        require(scans, "sweep.specimens", &names, "specimens with one scan or more each")?;
        let rubbers: Vec<String> = self.rubbers.iter().map(|path| stem(path)).collect();
        let rubbers: Vec<&str> = rubbers.iter().map(String::as_str).collect();
        let named = "file names of letters, digits, `.`, `_` and `-`, 100 at most, each once: they name tables and folders";
        require(are_names(&rubbers), "sweep.rubbers", &rubbers, named)?;
        let temperatures = &self.temperatures_c;
        let valid = temperatures.iter().all(|t| t.is_finite()) && once(temperatures);
        require(valid, "sweep.temperatures_c", temperatures, "finite numbers, each once")?;
        let seeds = &self.seeds;
        let valid = seeds.iter().all(|seed| *seed < 1 << 63) && once(seeds);
        require(valid, "sweep.seeds", seeds, "numbers below 2^63, each once")?;
        let cases = self.count();
        let least = "one list or more, and a million cases at most";
        require(
            (1..=MOST_CASES).contains(&cases) && *self != Self::default(),
            "sweep",
            format_args!("{cases} cases"),
            least,
        )
    }

    /// Number of combinations.
    fn count(&self) -> usize {
        let lengths =
            [self.specimens.len(), self.rubbers.len(), self.temperatures_c.len(), self.seeds.len()];
        lengths.into_iter().fold(1, |count, length| count.saturating_mul(length.max(1)))
    }
}

/// The values of a list, or nothing once.
fn each<T>(list: &[T]) -> Vec<Option<&T>> {
    if list.is_empty() { vec![None] } else { list.iter().map(Some).collect() }
}

impl Recipe {
    /// The cases of the recipe: one for every combination of the lists in `[sweep]`, specimens slowest and
    /// seeds fastest; the recipe itself where it has none.
    ///
    /// # Errors
    /// [`InvalidRecipe`] for lists that do not hold, and for the study of one sine.
    pub fn cases(&self) -> Result<Vec<Case>, InvalidRecipe> {
        if self.sinusoid.is_some() {
            return Err(InvalidRecipe::SweepOfSinusoid);
        }
        let sweep = self.sweep.clone().unwrap_or_default();
        let mut cases = Vec::with_capacity(sweep.count());
        for specimen in each(&sweep.specimens) {
            for rubber in each(&sweep.rubbers) {
                for temperature in each(&sweep.temperatures_c) {
                    for seed in each(&sweep.seeds) {
                        cases.push(self.case(specimen, rubber, temperature, seed)?);
                    }
                }
            }
        }
        Ok(cases)
    }

    fn case(
        &self,
        specimen: Option<&Specimen>,
        rubber: Option<&PathBuf>,
        temperature_c: Option<&f64>,
        seed: Option<&u64>,
    ) -> Result<Case, InvalidRecipe> {
        let mut recipe = Self { sweep: None, ..self.clone() };
        let missing = |section| InvalidRecipe::MissingSection { section };
        if let Some(specimen) = specimen {
            let ingest = recipe.ingest.as_mut().ok_or(missing("ingest"))?;
            ingest.scans.clone_from(&specimen.scans);
        }
        let bem = recipe.bem.as_mut().ok_or(missing("bem"))?;
        if let Some(rubber) = rubber {
            bem.rubber.clone_from(rubber);
        }
        if let Some(temperature_c) = temperature_c {
            bem.temperature_c = Some(*temperature_c);
        }
        let (rubber_name, shifted_c) = (stem(&bem.rubber), bem.temperature_c);
        let realise = recipe.realise.as_mut().ok_or(missing("realise"))?;
        realise.seed = seed.copied().or(realise.seed);
        let of_specimen = specimen.map(|specimen| format!("specimen={}", specimen.name));
        let of_rubber = rubber.map(|_| format!("rubber={rubber_name}"));
        let of_temperature = temperature_c.map(|celsius| format!("temperature_c={celsius}"));
        let of_seed = seed.map(|seed| format!("seed={seed}"));
        Ok(Case {
            specimen: specimen.map(|specimen| specimen.name.clone()),
            rubber: rubber_name,
            temperature_c: shifted_c,
            seed: realise.seed.unwrap_or_default(),
            surfaces: folder([&of_specimen, &of_seed]),
            folder: folder([&of_specimen, &of_rubber, &of_temperature, &of_seed]),
            recipe,
        })
    }

    /// Fails for lists that do not hold, and for a value that stands both in a list and in its own place.
    pub(super) fn check_sweep(&self) -> Result<(), InvalidRecipe> {
        let sweep = self.sweep.clone().unwrap_or_default();
        if self.sweep.is_some() {
            sweep.check()?;
        }
        let either = |listed: bool, single: bool, key, list| match (listed, single) {
            (false, false) => Err(InvalidRecipe::Missing { key, advice: list }),
            (true, true) => require(false, key, "given", "left out beside the list in [sweep]"),
            _ => Ok(()),
        };
        if let Some(ingest) = &self.ingest {
            // None at all may still come from the command line.
            let both = !sweep.specimens.is_empty() && !ingest.scans.is_empty();
            require(!both, "ingest.scans", &ingest.scans, "left out beside sweep.specimens")?;
        }
        if let Some(bem) = &self.bem {
            let listed = !sweep.rubbers.is_empty();
            let wanted = "give a rubber file, or files in sweep.rubbers";
            either(listed, bem.rubber != Path::new(""), "bem.rubber", wanted)?;
            let both = !sweep.temperatures_c.is_empty() && bem.temperature_c.is_some();
            let wanted = "left out beside sweep.temperatures_c";
            require(!both, "bem.temperature_c", bem.temperature_c, wanted)?;
        }
        if let Some(realise) = &self.realise {
            let wanted =
                "give a whole number from which the phases are drawn, or several in sweep.seeds";
            // Measured profiles alone have no phases to draw.
            if realise.draws() || !sweep.seeds.is_empty() {
                either(!sweep.seeds.is_empty(), realise.seed.is_some(), "realise.seed", wanted)?;
            }
        }
        Ok(())
    }
}

fn folder<const N: usize>(parts: [&Option<String>; N]) -> PathBuf {
    let path: PathBuf = parts.into_iter().flatten().collect();
    if path == Path::new("") { PathBuf::from("all") } else { path }
}

fn stem(path: &Path) -> String {
    crate::files::name::text(path.file_stem().unwrap_or_default())
}

fn once<T: PartialEq>(values: &[T]) -> bool {
    values.iter().enumerate().all(|(i, a)| values[..i].iter().all(|b| a != b))
}

/// Whether all are fit for folders, also on file systems that do not tell `A` from `a`.
/// Letters of a name that becomes a folder: file systems take 255 bytes.
const LONGEST_NAME: usize = 100;

fn are_names(names: &[&str]) -> bool {
    let fit = |name: &&str| {
        !name.is_empty()
            && !name.starts_with('.')
            && name.chars().count() <= LONGEST_NAME
            && name.chars().all(|c| c.is_alphanumeric() || "._-".contains(c))
    };
    let distinct: BTreeSet<String> = names.iter().map(|name| name.to_lowercase()).collect();
    names.iter().all(fit) && distinct.len() == names.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(sweep: &str) -> Result<Recipe, String> {
        let text = format!(
            "title = 'x'\n[ingest]\n[approximate]\nwaves = [3]\n[realise]\nwaves = [3]\n\
             realisations = 1\n[bem]\nspeeds_mm_s = [1.0]\n{sweep}"
        );
        Recipe::parse(&text, Path::new("folder/recipe.toml")).map_err(|error| error.to_string())
    }

    const ALL: &str = "[sweep]\nrubbers = ['a.toml', 'b.toml']\ntemperatures_c = [20, -5.5]\n\
                       seeds = [1, 2]\n[[sweep.specimens]]\nname = 'A'\nscans = ['scans/A']\n\
                       [[sweep.specimens]]\nname = 'B'\nscans = ['scans/B', 'more']\n";

    #[test]
    fn every_combination_is_a_case_in_a_folder_of_its_own() {
        let cases = parse(ALL).unwrap().cases().unwrap();
        assert_eq!(cases.len(), 16);
        let folders: BTreeSet<&PathBuf> = cases.iter().map(|case| &case.folder).collect();
        assert_eq!(folders.len(), 16);
        let surfaces: BTreeSet<&PathBuf> = cases.iter().map(|case| &case.surfaces).collect();
        assert_eq!(surfaces.len(), 4);
        let case = &cases[13];
        assert_eq!(case.folder, Path::new("specimen=B/rubber=b/temperature_c=20/seed=2"));
        assert_eq!(case.surfaces, Path::new("specimen=B/seed=2"));
        let recipe = &case.recipe;
        assert_eq!(recipe.sweep, None);
        assert_eq!(recipe.realise.as_ref().unwrap().seed, Some(2));
        let bem = recipe.bem.as_ref().unwrap();
        assert_eq!(
            (bem.rubber.as_path(), bem.temperature_c),
            (Path::new("folder/b.toml"), Some(20.0))
        );
        let scans = &recipe.ingest.as_ref().unwrap().scans;
        assert_eq!(scans, &[PathBuf::from("folder/scans/B"), PathBuf::from("folder/more")]);
    }

    #[test]
    fn lists_that_do_not_hold_are_named() {
        let change = |from: &str, to: &str| {
            assert!(ALL.contains(from));
            parse(&ALL.replace(from, to)).unwrap_err()
        };
        assert!(change("[1, 2]", "[1, 1]").contains("sweep.seeds = [1, 1]"));
        assert!(change("'b.toml'", "'other/a.toml'").contains("sweep.rubbers"));
        assert!(change("name = 'B'", "name = 'a'").contains("sweep.specimens"));
        assert!(change("name = 'B'", "name = '../B'").contains("sweep.specimens"));
        assert!(change("['scans/A']", "[]").contains("one scan or more each"));
        assert!(change("seeds = [1, 2]", "").contains("realise.seed"));
        assert!(change("rubbers = ['a.toml', 'b.toml']", "").contains("bem.rubber"));
        assert!(change("[20, -5.5]", "[20, nan]").contains("sweep.temperatures_c"));
        let twice = parse(&format!("rubber = 'c.toml'\n{ALL}")).unwrap_err();
        assert!(
            twice.contains("bem.rubber") && twice.contains("left out beside the list"),
            "{twice}"
        );
    }
}
