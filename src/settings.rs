//! `pipeline.toml`: as written -> ready to use.
//!
//! The defaults of the chosen profile come first, the keys of the file over them, the command line over both. A key
//! that is not known is an error, and so is a number out of its range.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Deserializer, Serialize};
use toml::{Table, Value};

use crate::alignment::Method;
use crate::error::{Result, RunError};
use crate::stages::{Stage, corner_filter, descriptor, isometry, merge, pair_match, parse, projection_sweep, validate};

/// Which set of defaults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Profile {
    /// The method made to work on real parts.
    #[default]
    Default,
    /// The literal reading of the paper, for comparison.
    Paper,
}

/// Limits for one model, so that one file cannot hold up or bring down a run of thousands. They do not count as
/// settings that results depend on: raise them and `run --retry-failed`. Only whether a model fails depends on them, and
/// for seconds and memory on the machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Largest model, bytes after decompression. The largest real files met have some hundreds of MB.
    pub bytes: u64,
    /// Most placed faces. A million is an assembly far beyond a part.
    pub faces: usize,
    /// Most triangles of the mesh. Twenty million take about 1 GB.
    pub triangles: usize,
    /// Seconds of computing for one model; 60 is a thousand times the mean. Where other programs leave the run less than
    /// one processor, the time on the clock counts less, down to a tenth.
    pub seconds: f64,
    /// Memory for one model, MB; 0: as much as for all together. Counted while it is computed on.
    pub model_memory_mb: u64,
    /// Memory for all models in flight together, MB; 0: half of what the machine, or the control group, has. A model
    /// waits until there is room, as estimated from its size and counted for those before it; one that needs more than
    /// all of it runs alone.
    pub memory_mb: u64,
    /// How many times its own size an archive may unpack to. STEP text shrinks 5 to 20 times.
    pub expansion: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            bytes: 1 << 30,
            faces: 1_000_000,
            triangles: 20_000_000,
            seconds: 60.0,
            model_memory_mb: 0,
            memory_mb: 0,
            expansion: 1000,
        }
    }
}

/// Everything that can be set; [`Settings::load`] reads it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The set of defaults that the file's keys lie over.
    pub profile: Profile,
    /// Files, folders and archives to read.
    #[serde(deserialize_with = "one_or_many")]
    pub input: Vec<PathBuf>,
    /// Folder of the store.
    pub store: PathBuf,
    /// CSV file with a category for each model, or `parent-folder`. Given: `run` ends with the report.
    pub labels: Option<PathBuf>,
    /// Folder that the report is written to.
    pub report: PathBuf,
    /// Frames to compute and compare, the first one the default of `query`.
    pub methods: Vec<Method>,
    /// Models computed at the same time, and a quarter more where there are several; 0: one for each core.
    pub jobs: usize,
    /// Gives every model a random rigid motion after reading, fixed by this seed and the model's bytes.
    pub random_pose: Option<u64>,
    /// Threads for each stage; a stage that is not named gets `jobs`.
    pub workers: BTreeMap<Stage, usize>,
    /// Models that may wait before each stage; a stage that is not named lets 2 wait.
    pub queues: BTreeMap<Stage, usize>,
    /// When a model is given up.
    pub limits: Limits,
    /// Thresholds of stage 1.
    pub parse: parse::Options,
    /// Thresholds of stage 2.
    pub corner_filter: corner_filter::Options,
    /// Thresholds of stage 3.
    pub pair_match: pair_match::Options,
    /// Thresholds of stage 4.
    pub isometry: isometry::Options,
    /// Thresholds of stage 5.
    pub validate: validate::Options,
    /// Thresholds of stage 6.
    pub merge: merge::Options,
    /// Thresholds of stage 7.
    pub projection_sweep: projection_sweep::Options,
    /// Sizes of stage 8.
    pub descriptor: descriptor::Options,
}

impl Default for Settings {
    fn default() -> Self {
        Self::profile(Profile::Default)
    }
}

/// Keys that results do not depend on.
const INDIFFERENT: [&str; 8] = ["input", "store", "labels", "report", "jobs", "workers", "queues", "limits"];

/// The key of the program's version among the settings of a store.
const VERSION: &str = "version";

impl Settings {
    /// The defaults of a profile.
    pub fn profile(profile: Profile) -> Self {
        match profile {
            Profile::Default => Self::with_stages(profile),
            Profile::Paper => Self {
                corner_filter: corner_filter::Options::paper(),
                pair_match: pair_match::Options::paper(),
                isometry: isometry::Options::paper(),
                validate: validate::Options::paper(),
                merge: merge::Options::paper(),
                projection_sweep: projection_sweep::Options::paper(),
                ..Self::with_stages(profile)
            },
        }
    }

    /// The default profile's settings under the name of `profile`.
    fn with_stages(profile: Profile) -> Self {
        Self {
            profile,
            input: Vec::new(),
            store: "store".into(),
            labels: None,
            report: "report".into(),
            methods: Method::USUAL.to_vec(),
            jobs: 0,
            random_pose: None,
            workers: BTreeMap::new(),
            queues: BTreeMap::new(),
            limits: Limits::default(),
            parse: parse::Options::default(),
            corner_filter: corner_filter::Options::default(),
            pair_match: pair_match::Options::default(),
            isometry: isometry::Options::default(),
            validate: validate::Options::default(),
            merge: merge::Options::default(),
            projection_sweep: projection_sweep::Options::default(),
            descriptor: descriptor::Options::default(),
        }
    }

    /// Reads a settings file; `profile` goes before the profile that the file names.
    ///
    /// Errors: the file cannot be read, is not TOML, has an unknown key, or a value out of its range.
    pub fn load(path: &Path, profile: Option<Profile>) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| RunError::file(path, e))?;
        Self::parse(&text, profile).map_err(|why| RunError::Settings(format!("{}: {why}", path.display())))
    }

    /// Reads the settings that a store holds: see [`Settings::effective`].
    pub fn of_store(text: &str) -> Result<Self> {
        let settings = || {
            let mut table: Table = text.parse().map_err(|e: toml::de::Error| e.to_string())?;
            table.remove(VERSION);
            Self::parse(&table.to_string(), None)
        };
        settings().map_err(|why| RunError::Settings(format!("of the store: {why}")))
    }

    /// Reads settings from TOML text; `profile` goes before the profile that the text names.
    pub fn parse(text: &str, profile: Option<Profile>) -> std::result::Result<Self, String> {
        // Read twice: only the text knows lines and columns, only the table knows which keys were written.
        let written: Self = toml::from_str(text).map_err(|e| e.to_string())?;
        let mut table: Table = text.parse().map_err(|e: toml::de::Error| e.to_string())?;
        table.remove("profile");
        let mut all = table_of(&Self::profile(profile.unwrap_or(written.profile)))?;
        overlay(&mut all, table);
        let settings: Self = all.try_into().map_err(|e: toml::de::Error| e.to_string())?;
        settings.check()?;
        Ok(settings)
    }

    /// Checks every value against its range. To be called again after changes from the command line.
    pub fn check(&self) -> std::result::Result<(), String> {
        check_numbers("", &Value::Table(table_of(self)?))?;
        let positive = [
            ("limits.bytes", self.limits.bytes > 0),
            ("limits.faces", self.limits.faces > 0),
            ("limits.triangles", self.limits.triangles > 0),
            ("limits.seconds", self.limits.seconds > 0.0),
            ("limits.expansion", self.limits.expansion > 0),
            ("validate.samples", self.validate.samples > 0),
            ("projection_sweep.planes", self.projection_sweep.planes > 0),
            ("projection_sweep.slices", self.projection_sweep.slices > 0),
            ("projection_sweep.pixels", self.projection_sweep.pixels > 0),
            ("descriptor.side", self.descriptor.side > 0),
            ("descriptor.points", self.descriptor.points > 0),
            ("every key of workers", self.workers.values().all(|n| *n > 0)),
            ("every key of queues", self.queues.values().all(|n| *n > 0)),
        ];
        if let Some((key, _)) = positive.iter().find(|(_, good)| !good) {
            return Err(format!("{key} must be above 0"));
        }
        self.check_methods()
    }

    fn check_methods(&self) -> std::result::Result<(), String> {
        let doubled = self.methods.iter().enumerate().find(|(i, method)| self.methods[..*i].contains(method));
        match doubled {
            Some((_, method)) => Err(format!("methods: {} is there twice", method.name())),
            None if self.methods.is_empty() => Err("methods: name at least one".into()),
            None => Ok(()),
        }
    }

    /// The settings that results depend on, as TOML with sorted keys; the program's version among them.
    pub fn effective(&self) -> Result<String> {
        let mut table = table_of(self).map_err(RunError::Settings)?;
        table.retain(|key, _| !INDIFFERENT.contains(&key));
        table.insert(VERSION.into(), env!("CARGO_PKG_VERSION").into());
        toml::to_string(&table).map_err(|e| RunError::Settings(e.to_string()))
    }

    /// Models computed at the same time.
    pub fn busy_limit(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, |n| n.get());
        if self.jobs == 0 { cores() } else { self.jobs }
    }

    /// Threads for a stage.
    pub fn workers_of(&self, stage: Stage) -> usize {
        self.workers.get(&stage).copied().unwrap_or_else(|| self.busy_limit())
    }

    /// Models that may wait before a stage.
    pub fn queue_of(&self, stage: Stage) -> usize {
        self.queues.get(&stage).copied().unwrap_or(2)
    }
}

fn table_of(settings: &Settings) -> std::result::Result<Table, String> {
    Table::try_from(settings).map_err(|e| e.to_string())
}

/// Puts the values of `over` in the place of those of `base`, table by table.
fn overlay(base: &mut Table, over: Table) {
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(inner)), Value::Table(value)) => overlay(inner, value),
            (_, value) => drop(base.insert(key, value)),
        }
    }
}

/// No setting is negative or not a number.
fn check_numbers(key: &str, value: &Value) -> std::result::Result<(), String> {
    let good = match value {
        Value::Integer(number) => *number >= 0,
        Value::Float(number) => number.is_finite() && *number >= 0.0,
        Value::Table(table) => {
            let dot = if key.is_empty() { "" } else { "." };
            return table.iter().try_for_each(|(name, value)| check_numbers(&format!("{key}{dot}{name}"), value));
        }
        Value::Array(values) => return values.iter().try_for_each(|value| check_numbers(key, value)),
        _ => true,
    };
    if good { Ok(()) } else { Err(format!("{key} is {value}; a finite number of at least 0 is due")) }
}

/// Accepts `input = "a"` and `input = ["a", "b"]`.
fn one_or_many<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Vec<PathBuf>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Paths {
        One(PathBuf),
        Many(Vec<PathBuf>),
    }
    Ok(match Paths::deserialize(deserializer)? {
        Paths::One(path) => vec![path],
        Paths::Many(paths) => paths,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_lies_over_the_profile() {
        let text = "profile = \"paper\"\ninput = \"models\"\n[limits]\nseconds = 5\n[workers]\nparse = 3";
        let settings = Settings::parse(text, None).unwrap();
        assert_eq!(settings.input, [PathBuf::from("models")]);
        assert_eq!((settings.limits.seconds, settings.limits.bytes), (5.0, Limits::default().bytes));
        assert_eq!((settings.workers_of(Stage::Parse), settings.queue_of(Stage::Merge)), (3, 2));
        assert_eq!(Settings::parse("", None).unwrap(), Settings::default());
    }

    #[test]
    fn the_settings_file_tells_every_default() {
        let text = include_str!("../pipeline.toml");
        let shipped = Settings::parse(text, None).unwrap();
        assert_eq!(shipped.effective().unwrap(), Settings::default().effective().unwrap());
        let bare = |line: &str| line.strip_prefix("# ").filter(|rest| rest.contains(" = ")).unwrap_or(line).to_owned();
        let of_stages = text.split_once("[parse]").unwrap().1.lines().map(|line| bare(line) + "\n");
        let told: Table = format!("[parse]\n{}", of_stages.collect::<String>()).parse().unwrap();
        let all = table_of(&Settings::default()).unwrap();
        for stage in Stage::ALL.map(Stage::name) {
            assert_eq!(told.get(stage), all.get(stage), "[{stage}]");
        }
        let written: Table = text.parse().unwrap();
        assert_eq!(written["limits"], all["limits"]);
    }

    #[test]
    fn a_bad_key_or_value_is_named() {
        let cases = [
            ("colour = 1", "colour"),
            ("[limits]\nsecond = 1", "second"),
            ("[limits]\nseconds = -1", "limits.seconds"),
            ("[limits]\nseconds = nan", "limits.seconds"),
            ("[limits]\nfaces = 0", "limits.faces"),
            ("[workers]\nparsing = 1", "parsing"),
            ("[queues]\nparse = 0", "queues"),
            ("methods = [\"pca\", \"pca\"]", "pca"),
            ("methods = []", "methods"),
            ("methods = [\"pcb\"]", "pcb"),
            ("profile = \"best\"", "best"),
            ("jobs = ", "1"),
        ];
        for (text, named) in cases {
            let error = Settings::parse(text, None).unwrap_err();
            assert!(error.contains(named), "{text}: {error}");
        }
    }

    #[test]
    fn what_does_not_change_results_does_not_change_the_fingerprint() {
        let base = Settings::default().effective().unwrap();
        let same =
            "input = \"x\"\njobs = 3\nstore = \"y\"\nlabels = \"z\"\n[workers]\nparse = 2\n[limits]\nseconds = 1";
        assert_eq!(Settings::parse(same, None).unwrap().effective().unwrap(), base);
        let other = Settings::parse("random_pose = 1", None).unwrap().effective().unwrap();
        assert_eq!(crate::store::differences(&base, &other), ["random_pose: not set, 1"]);
    }

    #[test]
    fn the_effective_settings_can_be_read_again() {
        let paper = Settings::profile(Profile::Paper);
        assert_eq!(Settings::of_store(&paper.effective().unwrap()).unwrap(), paper);
        assert_eq!(Settings::parse("profile = \"default\"", Some(Profile::Paper)).unwrap(), paper);
    }
}
