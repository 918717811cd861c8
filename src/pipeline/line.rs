//! Workers in a row, joined by bounded queues.

use std::sync::Arc;
use std::thread::{Builder, Scope};

use crossbeam_channel::{Receiver, Sender, bounded};

use super::parcel::{Job, Parcel};
use super::worker::{Bench, work};
use crate::settings::Settings;
use crate::stages::{ModelError, Scratch, Stage};

/// Stack of a worker, bytes: the default of a main thread, four times that of other threads, for the numerical
/// libraries' recursion on large models.
const STACK: usize = 8 << 20;

/// A stage, and what tells how many parcels wait before it.
pub type Queue = (Stage, Box<dyn Fn() -> usize + Send>);

/// The part of the pipeline that has been built: its open end gives parcels of `T`.
pub struct Line<'scope, 'env, T> {
    scope: &'scope Scope<'scope, 'env>,
    bench: &'scope Bench,
    settings: &'scope Settings,
    end: Receiver<Parcel<T>>,
    queues: Vec<Queue>,
}

impl<'scope, 'env, T: Send + 'scope> Line<'scope, 'env, T> {
    /// An empty line and the end that it is fed by.
    pub fn new(
        scope: &'scope Scope<'scope, 'env>,
        bench: &'scope Bench,
        settings: &'scope Settings,
    ) -> (Sender<Parcel<T>>, Self) {
        let (feed, end) = bounded(settings.queue_of(Stage::Parse));
        (feed, Self { scope, bench, settings, end, queues: Vec::new() })
    }

    /// The settings of the run.
    pub fn settings(&self) -> &'scope Settings {
        self.settings
    }

    /// Where its workers work.
    pub fn bench(&self) -> &'scope Bench {
        self.bench
    }

    /// The same line with the workers of one more stage.
    ///
    /// Errors: the system has no more threads.
    pub fn then<O: Send + 'scope>(
        mut self,
        stage: Stage,
        step: impl Fn(&Job, T, &mut Scratch) -> Result<O, ModelError> + Send + Sync + 'scope,
    ) -> std::io::Result<Line<'scope, 'env, O>>
    where
        T: 'static,
    {
        let next = Stage::ALL.get(stage as usize + 1).copied().unwrap_or(stage);
        let (outbox, end) = bounded(self.settings.queue_of(next));
        let step = Arc::new(step);
        for number in 0..self.settings.workers_of(stage) {
            let (inbox, outbox, step, bench) = (self.end.clone(), outbox.clone(), Arc::clone(&step), self.bench);
            let builder = Builder::new().name(format!("{}-{number}", stage.name())).stack_size(STACK);
            builder.spawn_scoped(self.scope, move || work(stage, bench, &inbox, &outbox, &*step))?;
        }
        let queue = self.end;
        self.queues.push((stage, Box::new(move || queue.len())));
        Ok(Line { scope: self.scope, bench: self.bench, settings: self.settings, end, queues: self.queues })
    }

    /// The parcels that come out, and the queues before each stage.
    pub fn finish(self) -> (Receiver<Parcel<T>>, Vec<Queue>) {
        (self.end, self.queues)
    }
}
