//! The command line: names and meanings of arguments, and the exit codes.

use std::path::PathBuf;

use clap::builder::RangedU64ValueParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use symalign::alignment::Method;
use symalign::evaluate::Named;
use symalign::pipeline::Shard;
use symalign::search::Name;
use symalign::settings::Profile;

/// Finds the mirror symmetries of CAD models, aligns them, describes them by silhouettes and scores retrieval.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Read models and keep their descriptors in a store; with labels, score retrieval
    Run(Run),
    /// Score retrieval over a store and write the report
    Eval(Eval),
    /// Find the models of a store that are most like a model
    Query(Query),
    /// Tell what a model is, its symmetries, frames and descriptors
    Inspect(Inspect),
    /// Write a model in its canonical pose as STEP, GLB, STL or OBJ
    Align(Align),
    /// List the rotations and mirrors that map models onto themselves, as BOP's models_info.json does
    Symmetries(Symmetries),
    /// Look at stores, check, export and join them
    #[command(subcommand)]
    Store(Store),
    /// Print the completions for a shell
    #[command(
        after_help = "Example:\n\x20 symalign completions bash > ~/.local/share/bash-completion/completions/symalign"
    )]
    Completions { shell: clap_complete::Shell },
    /// Write the manual pages, one for each command
    #[command(after_help = "Example:\n\x20 symalign man ~/.local/share/man/man1")]
    Man {
        /// Folder to write to
        dir: PathBuf,
    },
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n\
\x20 symalign run                                   everything as pipeline.toml says\n\
\x20 symalign run parts --store s                   a folder, an archive or a file\n\
\x20 symalign run parts --labels labels.csv --random-pose 1 --out report\n\
\x20 symalign run parts --shard 1/2 --store s1      the first of two machines\n\
\x20 dpkg-deb --fsys-tarfile models.deb | symalign run - --store s")]
pub struct Run {
    /// Files, folders, archives (.zip .tar .tar.gz .tar.xz .tar.zst .7z), or - for a tar stream on standard input
    pub input: Vec<PathBuf>,
    /// Settings file [default: pipeline.toml, if it is there]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Folder of the store
    #[arg(long, value_name = "DIR")]
    pub store: Option<PathBuf>,
    /// Models computed at the same time, and a quarter more where there are several [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: Option<u16>,
    /// Take only the K-th of N parts of the inputs
    #[arg(long, value_name = "K/N")]
    pub shard: Option<Shard>,
    /// Start over; removes what the store holds
    #[arg(long)]
    pub fresh: bool,
    /// Compute again what failed in an earlier run
    #[arg(long)]
    pub retry_failed: bool,
    /// Exit with 1 if a model failed
    #[arg(long)]
    pub strict: bool,
    /// Frames to compute
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = method)]
    pub method: Option<Vec<Method>>,
    /// Give every model a random rigid motion after reading, fixed by this seed
    #[arg(long, value_name = "SEED", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub random_pose: Option<u64>,
    /// Set of defaults that the settings file lies over
    #[arg(long, value_name = "NAME", value_parser = profile)]
    pub profile: Option<Profile>,
    /// Categories: a CSV file (path,category), a Princeton .cla file, or `parent-folder` [default: labels.csv in the
    /// input folder, if it is there]
    #[arg(long, value_name = "FILE")]
    pub labels: Option<PathBuf>,
    /// Folder that the report is written to
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Append what happens to this file as JSON lines: settings, each model's outcome and seconds, warnings, the end
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n\
\x20 symalign eval --store s --labels labels.csv --out report\n\
\x20 symalign eval --store s --method symmetry,cpca:phase\n\
\x20 symalign eval --labels psb.cla --matrix theirs=theirs.matrix      results of others")]
pub struct Eval {
    /// Folder of the store [default: store; none where the results of others are given]
    #[arg(long, value_name = "DIR")]
    pub store: Option<PathBuf>,
    /// Categories: a CSV file (path,category), a Princeton .cla file, or `parent-folder` [default: parent-folder]
    #[arg(long, value_name = "FILE")]
    pub labels: Option<PathBuf>,
    /// Folder that the report is written to
    #[arg(long, value_name = "DIR", default_value = "report")]
    pub out: PathBuf,
    /// Methods of the store to score, such as cpca, cpca:phase or cpca:swapped [default: all, magnitudes and phases]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub method: Option<Vec<Name>>,
    /// Score a Princeton distance matrix too, its rows in the order of the labels; may be repeated
    #[arg(long, value_name = "[NAME=]FILE")]
    pub matrix: Vec<Named>,
    /// Score a TREC run too; may be repeated
    #[arg(long, value_name = "[NAME=]FILE")]
    pub run: Vec<Named>,
    /// TREC judgements in place of labels
    #[arg(long, value_name = "FILE", conflicts_with = "labels")]
    pub qrels: Option<PathBuf>,
    /// Average as another evaluator does
    #[arg(long, value_enum)]
    pub compat: Option<Compat>,
}

/// Whose averages to follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Compat {
    /// The Princeton Shape Benchmark's: classes of one or two models are left out.
    Psb,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n\
\x20 symalign query part.step --store s -k 5\n\
\x20 symalign query part.step --store s --json      with the planes and faces behind the hits\n\
\x20 symalign query part.step --store s --out hits.html\n\
\x20 symalign query new-parts --store s --json      every model of a folder, in one pass over the store")]
pub struct Query {
    /// The models to look for: files, folders, archives
    #[arg(required = true)]
    pub model: Vec<PathBuf>,
    /// Folder of the store
    #[arg(long, value_name = "DIR", default_value = "store")]
    pub store: PathBuf,
    /// Number of hits
    #[arg(short, default_value_t = 10, value_parser = RangedU64ValueParser::<usize>::new().range(1..))]
    pub k: usize,
    /// Method to compare by, such as cpca or cpca:phase [default: the magnitudes of the store's first frame]
    #[arg(long, value_name = "M")]
    pub method: Option<Name>,
    /// Print JSON, one object a line for each model, with the planes and faces behind the hits
    #[arg(long)]
    pub json: bool,
    /// Write a page with the pictures of the hits of one model
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n\
\x20 symalign inspect part.step\n\
\x20 symalign inspect part.step --json | jq .symmetry.planes[0]\n\
\x20 symalign inspect archive.zip!folder/part.step --render pictures")]
pub struct Inspect {
    /// Models; `archive.zip!folder/part.step` names a member of an archive
    #[arg(required = true)]
    pub model: Vec<PathBuf>,
    /// Print one JSON object a line
    #[arg(long)]
    pub json: bool,
    /// Write pictures into this folder
    #[arg(long, value_name = "DIR")]
    pub render: Option<PathBuf>,
    /// Settings file [default: pipeline.toml, if it is there]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Frames to compute
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = method)]
    pub method: Option<Vec<Method>>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n\
\x20 symalign align part.step --out aligned.step    the same B-rep, moved; mm\n\
\x20 symalign align part.igs --out aligned.glb      triangles with normals; metres, as glTF asks for\n\
\x20 symalign align part.step --method cpca --out aligned.stl")]
pub struct Align {
    /// The model; `archive.zip!folder/part.step` names a member of an archive
    pub model: PathBuf,
    /// File to write; its ending says the format: .step (the same B-rep, moved), .glb, .stl or .obj
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Frame whose axes become x, y and z
    #[arg(long, value_name = "M", default_value = "symmetry", value_parser = method)]
    pub method: Method,
    /// Settings file [default: pipeline.toml, if it is there]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n\
\x20 symalign symmetries part.step\n\
\x20 symalign symmetries models/*.step --out models_info.json")]
pub struct Symmetries {
    /// Models; the objects are numbered in this order, or as files named obj_000001.step are
    #[arg(required = true)]
    pub model: Vec<PathBuf>,
    /// Print JSON, as without this
    #[arg(long)]
    pub json: bool,
    /// Write to this file instead
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Settings file [default: pipeline.toml, if it is there]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
#[command(after_help = "Examples:\n\
\x20 symalign store info s --json                   dtype, shape and offset of each section\n\
\x20 symalign store list s --failures\n\
\x20 symalign store merge s1 s2 --into s\n\
\x20 symalign store export s --format npy --out arrays")]
pub enum Store {
    /// Tell what a store holds and where its sections lie
    Info {
        #[arg(default_value = "store")]
        store: PathBuf,
        /// Print JSON with dtype, shape and offset of each section, for numpy.memmap
        #[arg(long)]
        json: bool,
    },
    /// List the models, one a line
    List {
        #[arg(default_value = "store")]
        store: PathBuf,
        /// List the failures with their reasons instead
        #[arg(long)]
        failures: bool,
    },
    /// Check every byte
    Verify {
        #[arg(default_value = "store")]
        store: PathBuf,
    },
    /// Write the store for other tools
    Export {
        #[arg(default_value = "store")]
        store: PathBuf,
        #[arg(long, value_enum, default_value_t = Format::Npy)]
        format: Format,
        /// Folder to write to
        #[arg(long, value_name = "DIR", default_value = "export")]
        out: PathBuf,
    },
    /// Join the stores of shards
    Merge {
        #[arg(required = true)]
        store: Vec<PathBuf>,
        /// Folder of the new store
        #[arg(long, value_name = "DIR")]
        into: PathBuf,
    },
}

/// What `store export` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// NumPy arrays and a list of ids.
    Npy,
    /// Parquet tables: the models, and the rows of each method.
    Parquet,
    /// Comma-separated text.
    Csv,
}

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All was done; failed models are counted, not fatal.
    Done,
    /// A model failed and `--strict` was given, or `inspect` could not read one.
    ModelFailed,
    /// Bad usage, bad settings, disk full, damaged store.
    CannotRun,
    /// Stopped by Ctrl-C or SIGTERM; what is done is kept.
    Interrupted,
}

impl Exit {
    /// The process's exit code.
    pub fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::ModelFailed => 1,
            Self::CannotRun => 2,
            Self::Interrupted => 130,
        }
    }
}

fn method(name: &str) -> Result<Method, String> {
    let known = || Method::ALL.map(Method::name).join(", ");
    Method::ALL.into_iter().find(|m| m.name() == name).ok_or_else(|| format!("the methods are {}", known()))
}

fn profile(name: &str) -> Result<Profile, String> {
    match name {
        "default" => Ok(Profile::Default),
        "paper" => Ok(Profile::Paper),
        _ => Err("the profiles are default and paper".into()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_arguments_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn exit_codes_are_those_of_the_contract() {
        let codes = [Exit::Done, Exit::ModelFailed, Exit::CannotRun, Exit::Interrupted].map(Exit::code);
        assert_eq!(codes, [0, 1, 2, 130]);
    }

    #[test]
    fn results_of_others_are_named() {
        let line = ["symalign", "eval", "--matrix", "a.matrix", "--matrix", "b=c", "--run", "x.run", "--qrels", "q"];
        let Command::Eval(eval) = Cli::try_parse_from(line).unwrap().command else { panic!("not an eval") };
        let names: Vec<_> = eval.matrix.iter().chain(&eval.run).map(|named| named.name.as_str()).collect();
        assert_eq!(names, ["a", "b", "x"]);
        assert!(Cli::try_parse_from(["symalign", "eval", "--qrels", "q", "--labels", "l"]).is_err());
    }

    #[test]
    fn lists_and_shards_are_read() {
        let line =
            ["symalign", "run", "a", "b.zip", "--method", "symmetry,cpca", "--shard", "2/8", "--random-pose", "1"];
        let Command::Run(run) = Cli::try_parse_from(line).unwrap().command else { panic!("not a run") };
        assert_eq!(run.method, Some(vec![Method::Symmetry, Method::Cpca]));
        assert_eq!((run.shard, run.random_pose), (Some(Shard { index: 2, count: 8 }), Some(1)));
        for bad in [["--method", "best"], ["--shard", "3/2"], ["--jobs", "0"], ["--random-pose", "-1"]] {
            assert!(Cli::try_parse_from(["symalign", "run"].into_iter().chain(bad)).is_err(), "{bad:?}");
        }
    }
}
