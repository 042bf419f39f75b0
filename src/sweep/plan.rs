//! The plan of a sweep: which tasks are missing and which shard solves them.

use super::cost::{Cost, Costs};
use super::layout::{Layout, PLAN_FILE};
use super::prepare::scan_digests;
use super::task::{Solvers, Task};
use super::{Prepared, SweepError, shares};
use crate::artifact::{Digest, SolveStore, TOOL_VERSION, write_by_rename};
use crate::recipe::Recipe;
use crate::rubber::RubberModel;
use crate::stages::Watch;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const PLAN_SCHEMA: &str = "asperity.sweep.plan";
const SHARD_SCHEMA: &str = "asperity.sweep.shard";
const VERSION: u32 = 1;
/// Memory of the program before any contact.
const BASE_MEGABYTES: f64 = 40.0;

/// A task of a shard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedTask {
    /// Number of the case that wants it, the first of several.
    pub case: usize,
    /// Number of its rubber in the plan.
    pub material: usize,
    /// Digest under which its solves are kept.
    pub problem: Digest,
    /// Digest of all that determines its solves.
    pub key: Digest,
    /// What is to be solved.
    #[serde(flatten)]
    pub task: Task,
}

/// The list of a shard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShardTasks {
    schema: String,
    version: u32,
    /// Number of the shard, from 0.
    pub shard: usize,
    /// Tasks in the order in which they are begun; those of one problem follow each other.
    pub tasks: Vec<PlannedTask>,
    digest: Digest,
}

/// What the plan says about a shard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedShard {
    /// Number of tasks.
    pub tasks: usize,
    /// Expected seconds on one thread of the machine of reference.
    pub seconds: f64,
    /// Expected memory of its largest task in MB.
    pub megabytes: f64,
    /// Digest of its list.
    pub digest: Digest,
}

/// The plan of a sweep, `plan.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepPlan {
    schema: String,
    version: u32,
    /// Version of the tool that made it, which shards and collection must have too.
    pub tool_version: String,
    /// The recipe, paths absolute.
    pub recipe: Recipe,
    /// Number of cases.
    pub cases: usize,
    /// The rubbers, each at each temperature.
    pub rubbers: Vec<RubberModel>,
    /// Digests of the scans of each specimen.
    pub scans: BTreeMap<String, Digest>,
    /// The shards.
    pub shards: Vec<PlannedShard>,
    /// Seconds of the machine that planned for one of the reference; no part of the digest.
    pub slowness: f64,
    digest: Digest,
}

/// A task that a case wants.
#[derive(Debug, Clone)]
pub(super) struct Wanted {
    pub case: usize,
    pub problem: Digest,
    key: Digest,
    pub task: Task,
}

impl Wanted {
    pub fn new(case: usize, task: Task, solvers: &Solvers, rubber: &RubberModel) -> Self {
        let (problem, key) = (task.problem(solvers, rubber), task.key(solvers, rubber));
        Self { case, problem, key, task }
    }
}

impl SweepPlan {
    /// Number of tasks.
    pub fn tasks(&self) -> usize {
        self.shards.iter().map(|shard| shard.tasks).sum()
    }

    /// Expected seconds of each shard on one thread of the machine that planned.
    pub fn seconds(&self) -> impl Iterator<Item = f64> {
        self.shards.iter().map(|shard| self.slowness * shard.seconds)
    }

    /// Expected memory in MB of a shard that solves so many tasks at once.
    pub fn megabytes(&self, threads: usize) -> f64 {
        let most = self.shards.iter().map(|shard| shard.megabytes).fold(0.0, f64::max);
        BASE_MEGABYTES + most * threads as f64
    }

    /// Digest of all but what was measured.
    fn seal(&self) -> Result<Digest, SweepError> {
        Ok(Digest::seal_of(&Self { slowness: 0.0, ..self.clone() })?)
    }
}

/// Lists the tasks of a recipe that are missing in the folder `out` and deals them to shards; returns the
/// path of the plan, which is named by its content, and the plan.
///
/// The same recipe, folder and number of shards give the same plan.
///
/// # Errors
/// Those of the stages up to the realisations, and of the trial curves.
pub fn plan(
    recipe: &Recipe,
    out: &Path,
    shards: usize,
    watch: Watch,
) -> Result<(PathBuf, SweepPlan), SweepError> {
    let layout = Layout::new(out);
    let prepared = Prepared::new(recipe, layout.clone(), watch)?;
    let store = SolveStore::open_packed(layout.solves())?;
    let costs = Costs::try_out(&prepared, &prepared.solvers, &store, watch)?;
    let wanted = prepared.missing(&store, watch)?;
    let (lists, planned) = deal(&groups(wanted), &prepared, &costs, shards)?;
    let mut plan = SweepPlan {
        schema: PLAN_SCHEMA.to_owned(),
        version: VERSION,
        tool_version: TOOL_VERSION.to_owned(),
        recipe: recipe.clone(),
        cases: prepared.cases.len(),
        rubbers: prepared.materials.iter().map(|material| material.rubber.clone()).collect(),
        scans: scan_digests(&prepared.scans),
        shards: planned,
        slowness: costs.slowness,
        digest: Digest::of_bytes(&[]),
    };
    plan.digest = plan.seal()?;
    let path = write(&layout, &plan, &lists)?;
    Ok((path, plan))
}

/// The list of each shard and what the plan says about it, of groups of tasks that are not parted.
fn deal(
    groups: &[Vec<Wanted>],
    prepared: &Prepared,
    costs: &Costs,
    shards: usize,
) -> Result<(Vec<ShardTasks>, Vec<PlannedShard>), SweepError> {
    let together = |sum: Cost, cost: Cost| Cost {
        seconds: sum.seconds + cost.seconds,
        megabytes: sum.megabytes.max(cost.megabytes),
    };
    let cost = |group: &Vec<Wanted>| {
        let costs = group.iter().map(|w| costs.of(&w.task, &prepared.cases[w.case]));
        costs.fold(Cost::default(), together)
    };
    let group_costs: Vec<Cost> = groups.iter().map(cost).collect();
    let seconds: Vec<f64> = group_costs.iter().map(|cost| cost.seconds).collect();
    let (mut lists, mut planned) = (Vec::with_capacity(shards), Vec::with_capacity(shards));
    for (shard, share) in shares::deal(&seconds, shards).into_iter().enumerate() {
        let tasks = share.iter().flat_map(|group| &groups[*group]);
        let list = ShardTasks::new(shard, tasks.map(|w| w.planned(prepared)).collect())?;
        let whole = share.iter().map(|group| group_costs[*group]).fold(Cost::default(), together);
        planned.push(PlannedShard {
            tasks: list.tasks.len(),
            seconds: whole.seconds,
            megabytes: whole.megabytes,
            digest: list.digest,
        });
        lists.push(list);
    }
    Ok((lists, planned))
}

/// Tasks of one problem, which write one file, in the order of the first of them; a task that several
/// cases want counts once.
fn groups(wanted: Vec<Wanted>) -> Vec<Vec<Wanted>> {
    let mut numbers: BTreeMap<Digest, usize> = BTreeMap::new();
    let mut groups: Vec<Vec<Wanted>> = Vec::new();
    for task in wanted {
        let number = *numbers.entry(task.problem).or_insert(groups.len());
        if number == groups.len() {
            groups.push(Vec::new());
        }
        if groups[number].iter().all(|other| other.key != task.key) {
            groups[number].push(task);
        }
    }
    groups
}

impl Wanted {
    fn planned(&self, prepared: &Prepared) -> PlannedTask {
        let Self { case, problem, key, task } = self.clone();
        PlannedTask { case, material: prepared.material_of[case], problem, key, task }
    }
}

impl ShardTasks {
    fn new(shard: usize, tasks: Vec<PlannedTask>) -> Result<Self, SweepError> {
        let (schema, digest) = (SHARD_SCHEMA.to_owned(), Digest::of_bytes(&[]));
        let mut list = Self { schema, version: VERSION, shard, tasks, digest };
        list.digest = Digest::seal_of(&list)?;
        Ok(list)
    }

    fn file(shard: usize) -> String {
        format!("shard_{shard:05}.json")
    }

    /// Reads the list of a shard of the plan at `path`.
    ///
    /// # Errors
    /// [`SweepError::NoSuchShard`]; [`SweepError::BadPlan`] for a list that is not that of the plan.
    pub fn read(path: &Path, plan: &SweepPlan, shard: usize) -> Result<Self, SweepError> {
        let shards = plan.shards.len();
        let planned = plan.shards.get(shard).ok_or(SweepError::NoSuchShard { shard, shards })?;
        let path = path.with_file_name(Self::file(shard));
        let list: Self = read_json(&path)?;
        if Digest::seal_of(&list)? != planned.digest || list.digest != planned.digest {
            let reason = "it is not the list that the plan was made with".into();
            return Err(SweepError::BadPlan { path, reason });
        }
        Ok(list)
    }
}

/// Writes the lists, then the plan, into a folder that is renamed into place. A plan that is there
/// already has the same content.
fn write(layout: &Layout, plan: &SweepPlan, lists: &[ShardTasks]) -> Result<PathBuf, SweepError> {
    let plans = layout.plans();
    fn failed(path: &Path) -> impl Fn(std::io::Error) -> SweepError {
        move |source| SweepError::Io { action: "write", path: path.to_owned(), source }
    }
    layout.check_links(&plans)?;
    std::fs::create_dir_all(&plans).map_err(failed(&plans))?;
    let place = plans.join(format!("{:#}", plan.digest));
    if is_whole(&place.join(PLAN_FILE)) {
        return Ok(place.join(PLAN_FILE));
    }
    let folder = tempfile::Builder::new()
        .prefix(".asperity-")
        .permissions(crate::files::os::shared_folder())
        .tempdir_in(&plans)
        .map_err(failed(&plans))?;
    for list in lists {
        write_json(&folder.path().join(ShardTasks::file(list.shard)), list)?;
    }
    write_json(&folder.path().join(PLAN_FILE), plan)?;
    match std::fs::rename(folder.path(), &place) {
        Ok(()) => drop(folder.keep()),
        // Another process has made it.
        Err(_) if is_whole(&place.join(PLAN_FILE)) => {}
        Err(error) if !is_occupied(&error) => return Err(failed(&place)(error)),
        // What is damaged gives way to what is not, file by file.
        Err(_) => {
            layout.check_links(&place)?;
            for list in lists {
                write_json(&place.join(ShardTasks::file(list.shard)), list)?;
            }
            write_json(&place.join(PLAN_FILE), plan)?;
        }
    }
    Ok(place.join(PLAN_FILE))
}

/// Whether a folder was not renamed because of what is in its place.
fn is_occupied(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{AlreadyExists, DirectoryNotEmpty, NotADirectory};
    [AlreadyExists, DirectoryNotEmpty, NotADirectory].contains(&error.kind())
}

/// Whether the plan and all its lists are as they were written.
fn is_whole(path: &Path) -> bool {
    read_plan(path).is_ok_and(|plan| {
        (0..plan.shards.len()).all(|shard| ShardTasks::read(path, &plan, shard).is_ok())
    })
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), SweepError> {
    let bytes = serde_json::to_vec(value).map_err(|error| SweepError::BadPlan {
        path: path.to_owned(),
        reason: error.to_string(),
    })?;
    Ok(write_by_rename(path, &bytes)?)
}

fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, SweepError> {
    let io = |source| SweepError::Io { action: "read", path: path.to_owned(), source };
    let bytes = crate::files::read(path, crate::files::LARGEST_NUMBERS).map_err(io)?;
    serde_json::from_slice(&bytes).map_err(|error| SweepError::BadPlan {
        path: path.to_owned(),
        reason: format!("it cannot be read ({error}): it is damaged or no plan"),
    })
}

/// Reads a plan.
///
/// # Errors
/// [`SweepError::NoPlan`], [`SweepError::BadPlan`]; [`SweepError::OtherVersion`] for that of another
/// version of the tool.
pub fn read_plan(path: &Path) -> Result<SweepPlan, SweepError> {
    #[derive(Deserialize)]
    struct Header {
        schema: String,
        version: u32,
        tool_version: String,
    }
    if !path.is_file() {
        return Err(SweepError::NoPlan { path: path.to_owned() });
    }
    let header: Header = read_json(path)?;
    if header.schema != PLAN_SCHEMA {
        return Err(SweepError::NoPlan { path: path.to_owned() });
    }
    if (header.version, header.tool_version.as_str()) != (VERSION, TOOL_VERSION) {
        let (path, found) = (path.to_owned(), header.tool_version);
        return Err(SweepError::OtherVersion { path, found, ours: TOOL_VERSION });
    }
    let plan: SweepPlan = read_json(path)?;
    if plan.seal()? != plan.digest {
        let reason = "it was changed or damaged after it was written".into();
        return Err(SweepError::BadPlan { path: path.to_owned(), reason });
    }
    Ok(plan)
}
