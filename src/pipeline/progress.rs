//! What a run tells while it goes on: bars on a terminal, plain lines elsewhere. All of it on standard error.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, MultiProgress, ProgressBar, ProgressStyle};

use crate::stages::Stage;

/// How a run stands.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Models met so far.
    pub found: u64,
    /// Models there will be, if that is known.
    pub total: Option<u64>,
    /// Computed in this run.
    pub done: u64,
    pub failed: u64,
    /// Left out: known from an earlier run, or the same bytes as another model.
    pub known: u64,
    /// Bytes of the models that were computed.
    pub bytes: u64,
    pub elapsed: Duration,
    /// For each stage: workers that are computing, and models that wait.
    pub stages: Vec<(Stage, usize, usize)>,
    /// The model in flight that has been computed on longest.
    pub slowest: Option<(String, Stage, f64)>,
}

impl Snapshot {
    fn settled(&self) -> u64 {
        self.done + self.failed + self.known
    }

    /// Models and megabytes a second.
    fn rates(&self) -> (f64, f64) {
        let seconds = self.elapsed.as_secs_f64().max(1e-3);
        ((self.done + self.failed) as f64 / seconds, self.bytes as f64 / 1e6 / seconds)
    }

    fn left(&self) -> Option<Duration> {
        let left = self.total?.saturating_sub(self.settled());
        let rate = self.rates().0;
        (rate > 0.0).then(|| Duration::from_secs_f64(left as f64 / rate))
    }

    /// The run in one line.
    pub fn line(&self) -> String {
        let (models, megabytes) = self.rates();
        let total = self.total.map_or_else(|| format!("{}+", self.found), |total| total.to_string());
        let time = self.left().map_or_else(String::new, |time| format!(", {} to go", HumanDuration(time)));
        let known = if self.known > 0 { format!(", {} known", self.known) } else { String::new() };
        let unsettled = self.total.unwrap_or(self.found).saturating_sub(self.settled());
        format!(
            "{} of {total}: {} done, {} failed{known}, {unsettled} left; {models:.1} models/s, {megabytes:.1} MB/s{time}",
            self.settled(),
            self.done,
            self.failed
        )
    }

    fn slowest_line(&self) -> String {
        self.slowest.as_ref().map_or_else(String::new, |(id, stage, seconds)| {
            format!("slowest in flight: {id}, {} for {seconds:.1} s", stage.name())
        })
    }
}

/// Shows a run's progress.
pub enum Progress {
    /// Bars on a terminal.
    Bars(Box<Bars>),
    /// A line every few seconds.
    Lines(Lines),
    /// Nothing.
    Silent,
}

impl Progress {
    /// Bars where standard error is a terminal, else lines.
    pub fn for_stderr() -> Self {
        if std::io::stderr().is_terminal() { Self::Bars(Box::default()) } else { Self::Lines(Lines::default()) }
    }

    /// Shows how the run stands; may be called often.
    pub fn show(&mut self, snapshot: &Snapshot) {
        match self {
            Self::Bars(bars) => bars.show(snapshot),
            Self::Lines(lines) => lines.show(snapshot),
            Self::Silent => {}
        }
    }

    /// Clears the bars.
    pub fn finish(&mut self) {
        if let Self::Bars(bars) = self {
            // A terminal that went away is no reason to fail.
            let _ = bars.all.clear();
        }
    }
}

/// One bar for the whole, one line a stage, the slowest model.
pub struct Bars {
    all: MultiProgress,
    whole: ProgressBar,
    stages: Vec<ProgressBar>,
    slowest: ProgressBar,
}

impl Default for Bars {
    fn default() -> Self {
        let all = MultiProgress::new();
        let bar = "{elapsed_precise} [{wide_bar}] {percent:>3} %\n  {wide_msg}";
        let whole = all.add(ProgressBar::no_length().with_style(style(bar)));
        let line = || all.add(ProgressBar::no_length().with_style(style("  {wide_msg}")));
        let stages = Stage::ALL.iter().map(|_| line()).collect();
        let slowest = line();
        Self { all, whole, stages, slowest }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

impl Bars {
    fn show(&mut self, snapshot: &Snapshot) {
        self.whole.set_length(snapshot.total.unwrap_or(snapshot.found).max(1));
        self.whole.set_position(snapshot.settled());
        self.whole.set_message(snapshot.line());
        for (bar, (stage, busy, waiting)) in self.stages.iter().zip(&snapshot.stages) {
            bar.set_message(format!("{:<17}{busy:>3} busy {waiting:>3} waiting", stage.name()));
        }
        self.slowest.set_message(snapshot.slowest_line());
    }
}

/// A plain line every few seconds.
pub struct Lines {
    last: Instant,
    shown: String,
}

/// Time between two lines.
const EVERY: Duration = Duration::from_secs(5);

impl Default for Lines {
    fn default() -> Self {
        Self { last: Instant::now(), shown: String::new() }
    }
}

impl Lines {
    fn show(&mut self, snapshot: &Snapshot) {
        if self.last.elapsed() < EVERY {
            return;
        }
        self.last = Instant::now();
        let line = [snapshot.line(), snapshot.slowest_line()].join("; ");
        if line != self.shown {
            // A closed standard error is no reason to fail.
            let _ = writeln!(std::io::stderr(), "{}", line.trim_end_matches("; "));
            self.shown = line;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_tells_counts_rates_and_the_time_left() {
        let snapshot = Snapshot {
            found: 40,
            total: Some(100),
            done: 18,
            failed: 2,
            known: 10,
            bytes: 50_000_000,
            elapsed: Duration::from_secs(10),
            ..Snapshot::default()
        };
        let expected = "30 of 100: 18 done, 2 failed, 10 known, 70 left; 2.0 models/s, 5.0 MB/s, 35 seconds to go";
        assert_eq!(snapshot.line(), expected);
        let unknown = Snapshot { total: None, known: 0, ..snapshot };
        assert_eq!(unknown.line(), "20 of 40+: 18 done, 2 failed, 20 left; 2.0 models/s, 5.0 MB/s");
    }
}
