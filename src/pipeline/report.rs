//! How a run ended, and that in words.

use std::collections::BTreeMap;
use std::time::Duration;

use super::parcel::{Job, Seconds};
use crate::stages::Stage;
use crate::store::Failure;

/// Models listed as slowest.
const SLOWEST: usize = 10;
/// Reasons of failures listed, the most frequent first.
const REASONS: usize = 20;

/// How a run ended.
#[derive(Debug, Default)]
pub struct Report {
    /// Models of the inputs that the store has, computed now or earlier.
    pub done: usize,
    /// Models of the inputs that were lost, now or earlier, sorted by id.
    pub failures: Vec<Failure>,
    /// Models computed or lost in this run.
    pub computed: u64,
    /// Bytes of the models computed or lost in this run.
    pub bytes: u64,
    /// Stopped from outside: nothing was published, all that is done is in the journal.
    pub interrupted: bool,
    /// What the user should know about the store.
    pub notes: Vec<String>,
    /// Seconds of computing in this run, by stage.
    pub seconds: Seconds,
    /// The models that took longest in this run, longest first: id and seconds.
    pub slowest: Vec<(String, f64)>,
    /// Most memory that the process had in use, bytes; `None` where the system does not tell.
    pub peak_memory: Option<u64>,
    /// From start to end.
    pub elapsed: Duration,
}

impl Report {
    /// Notes that a model arrived.
    pub fn note(&mut self, job: &Job) {
        let seconds = job.seconds();
        self.computed += 1;
        self.bytes += job.bytes;
        self.seconds.iter_mut().zip(seconds).for_each(|(sum, s)| *sum += s);
        self.slowest.push((job.id.clone(), seconds.iter().sum()));
        self.slowest.sort_by(|a, b| b.1.total_cmp(&a.1));
        self.slowest.truncate(SLOWEST);
    }

    /// The end of a run in words: counts, rates, peak memory, failures by reason, times by stage, slowest models.
    pub fn summary(&self) -> String {
        let mut lines = self.notes.clone();
        lines.push(self.counts());
        lines.extend(self.reasons());
        if self.computed > 0 {
            let all = self.seconds.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            let times = Stage::ALL.iter().zip(self.seconds);
            let times = times.map(|(stage, s)| format!("{} {s:.1} s ({:.0} %)", stage.name(), 100.0 * s / all));
            lines.push(format!("computing time: {}", times.collect::<Vec<_>>().join(", ")));
            lines.push("slowest models:".into());
            lines.extend(self.slowest.iter().map(|(id, seconds)| format!("  {seconds:7.2} s  {id}")));
        }
        lines.join("\n")
    }

    fn counts(&self) -> String {
        let seconds = self.elapsed.as_secs_f64().max(1e-3);
        let (models, megabytes) = (self.computed as f64 / seconds, self.bytes as f64 / 1e6 / seconds);
        let memory =
            self.peak_memory.map_or_else(String::new, |bytes| format!("; peak memory {} MB", bytes / 1_000_000));
        format!(
            "{} models done, {} failed; {} computed in {seconds:.1} s, {models:.1} models/s, {megabytes:.1} MB/s{memory}",
            self.done,
            self.failures.len(),
            self.computed
        )
    }

    /// The failures by stage and kind of reason, the most frequent first.
    fn reasons(&self) -> Vec<String> {
        let mut groups: BTreeMap<(Stage, String), Vec<&Failure>> = BTreeMap::new();
        for failure in &self.failures {
            groups.entry((failure.error.stage, pattern(&failure.error.why))).or_default().push(failure);
        }
        let mut groups: Vec<_> = groups.into_iter().collect();
        groups.sort_by_key(|(_, failures)| std::cmp::Reverse(failures.len()));
        let mut lines: Vec<String> = groups.iter().take(REASONS).map(|((_, kind), of)| line(kind, of)).collect();
        if groups.len() > REASONS {
            let rest: usize = groups[REASONS..].iter().map(|(_, failures)| failures.len()).sum();
            lines.push(format!("  failed {rest} times for other reasons: see symalign store list --failures"));
        }
        lines
    }
}

/// One group of failures: the reason itself where it is the same for all, else its kind.
fn line(kind: &str, failures: &[&Failure]) -> String {
    let first = failures[0];
    let same = failures.iter().all(|failure| failure.error.why == first.error.why);
    let why = if same { &first.error.why } else { kind };
    let count = failures.len();
    let times = if count == 1 { "once" } else { &format!("{count} times") };
    format!(
        "  failed {times}: {}: {why} ({}{})",
        first.error.stage.name(),
        if count > 1 { "first " } else { "" },
        first.id
    )
}

/// A reason with `N` for each number, so that entities and quantities do not set equal reasons apart. Digits that
/// belong to a word, as in AP214, are kept.
fn pattern(why: &str) -> String {
    let mut kind = String::new();
    let mut rest = why;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let word = rest[..start].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let number = |c: char| c.is_ascii_digit() || (!word && matches!(c, '.' | 'e' | 'E' | '+' | '-'));
        let length = rest[start..].find(|c| !number(c)).unwrap_or(rest.len() - start);
        // What ends a sentence, or joins a word, is none of the number.
        let length = start + rest[start..start + length].trim_end_matches(|c: char| !c.is_ascii_digit()).len();
        kind += if word { &rest[..length] } else { &rest[..start] };
        kind += if word { "" } else { "N" };
        rest = &rest[length..];
    }
    kind + rest
}

/// The largest memory in use that the system noted for this process, bytes.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::ModelError;

    fn failure(id: &str, why: &str) -> Failure {
        Failure { id: id.into(), hash: None, error: ModelError::new(Stage::Parse, why) }
    }

    #[test]
    fn numbers_do_not_set_reasons_apart() {
        let cases = [
            ("#12 is missing", "#N is missing"),
            ("face 7 of 1.5e-3 mm, at byte 99.", "face N of N mm, at byte N."),
            ("AP214 and utf8 stay, 3D does not", "AP214 and utf8 stay, ND does not"),
            ("2 bytes - 3, 4-fold", "N bytes - N, N-fold"),
            ("no number", "no number"),
            ("é7 ü 8", "é7 ü N"),
        ];
        for (why, kind) in cases {
            assert_eq!(pattern(why), kind, "{why}");
        }
    }

    #[test]
    fn the_summary_tells_counts_rates_memory_reasons_and_times() {
        let failures = [("a", "#1 is missing"), ("b", "torn"), ("c", "#22 is missing"), ("d", "more than 9 faces")];
        let mut report = Report {
            done: 6,
            failures: failures.map(|(id, why)| failure(id, why)).to_vec(),
            computed: 8,
            bytes: 20_000_000,
            seconds: [3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            slowest: vec![("z".into(), 2.5)],
            peak_memory: Some(123_456_789),
            elapsed: Duration::from_secs(4),
            ..Report::default()
        };
        let expected = "6 models done, 4 failed; 8 computed in 4.0 s, 2.0 models/s, 5.0 MB/s; peak memory 123 MB\n  \
             failed 2 times: parse: #N is missing (first a)\n  failed once: parse: more than 9 faces (d)\n  \
             failed once: parse: torn (b)\ncomputing time: parse 3.0 s (75 %), ";
        assert!(report.summary().starts_with(expected), "{}", report.summary());
        assert!(report.summary().ends_with("descriptor 1.0 s (25 %)\nslowest models:\n     2.50 s  z"));

        let many = (0..30).map(|i| failure("m", &format!("reason {}", "x".repeat(i)))).collect();
        report.failures = many;
        assert!(report.summary().contains("failed 10 times for other reasons"), "{}", report.summary());
    }
}
