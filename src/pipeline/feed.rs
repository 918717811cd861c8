//! The source end: members of the inputs, hashed, those of other shards and those known left out.

use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam_channel::Sender;

use super::Counters;
use super::budget::Budget;
use super::parcel::{Job, Parcel};
use super::worker::Bench;
use crate::archive::{self, Member};
use crate::error::Result;
use crate::settings::Settings;
use crate::stages::{ModelError, Stage};
use crate::store::{Failure, Hash};

/// One of several runs that share the inputs by the hash of the models' bytes: number `index` of `count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1 to `count`.
    pub index: u64,
    /// Number of parts.
    pub count: u64,
}

impl Shard {
    /// Whether a model with this hash is ours.
    pub fn owns(&self, hash: &Hash) -> bool {
        let lead = u64::from_le_bytes(std::array::from_fn(|i| hash[i]));
        lead % self.count == self.index - 1
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    /// Reads `K/N` with 1 <= K <= N.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let wrong = || format!("{text}: a shard is K/N with 1 <= K <= N, such as 2/8");
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let (index, count) = (index.parse().map_err(|_| wrong())?, count.parse().map_err(|_| wrong())?);
        if (1..=count).contains(&index) { Ok(Self { index, count }) } else { Err(wrong()) }
    }
}

/// What the inputs held.
#[derive(Default)]
pub struct Manifest {
    /// Id and content hash of every model of this shard.
    pub models: Vec<(String, Hash)>,
    /// Models without bytes.
    pub unreadable: Vec<Failure>,
    /// Every input was read to its end.
    pub complete: bool,
}

impl Manifest {
    /// All inputs were read and held nothing.
    pub fn is_empty(&self) -> bool {
        self.complete && self.models.is_empty() && self.unreadable.is_empty()
    }
}

/// Reads the inputs and sends what has to be computed.
pub struct Feed<'a> {
    pub settings: &'a Settings,
    pub shard: Option<Shard>,
    /// Content hashes that need no computing.
    pub known: HashSet<Hash>,
    pub budget: &'a Budget,
    pub bench: &'a Bench,
    pub counters: &'a Counters,
    /// Set from outside: stop reading.
    pub stop: &'a AtomicBool,
}

impl Feed<'_> {
    /// Visits all inputs; ends early when told to stop or when nobody takes the parcels.
    pub fn run(mut self, outbox: &Sender<Parcel<Vec<u8>>>) -> Result<Manifest> {
        let mut manifest = Manifest::default();
        let mut ids = HashSet::new();
        let mut going = true;
        let limits = archive::Limits { bytes: self.settings.limits.bytes, expansion: self.settings.limits.expansion };
        let (budget, bench, stop) = (self.budget, self.bench, self.stop);
        let told_to_stop = || stop.load(Ordering::Relaxed);
        let room = |bytes| {
            budget.wait_to_read(bytes, &|| bench.memory());
            if told_to_stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        archive::visit(&self.settings.input, &limits, &room, &mut |mut member| {
            going = !told_to_stop();
            if going {
                // Archives may hold a name twice.
                member.id = archive::unique(member.id, &mut ids);
                going = self.member(member, &mut manifest, outbox);
            }
            if going { ControlFlow::Continue(bench.files.take()) } else { ControlFlow::Break(()) }
        })?;
        manifest.complete = going && !told_to_stop();
        Ok(manifest)
    }

    /// False: told to stop, or nobody takes the parcels any more.
    fn member(&mut self, member: Member, manifest: &mut Manifest, outbox: &Sender<Parcel<Vec<u8>>>) -> bool {
        let hash = match &member.bytes {
            Ok(bytes) => *blake3::hash(bytes).as_bytes(),
            Err(_) => *blake3::hash(member.id.as_bytes()).as_bytes(),
        };
        if self.shard.is_some_and(|shard| !shard.owns(&hash)) {
            return true;
        }
        let number = self.counters.found.fetch_add(1, Ordering::Relaxed);
        match member.bytes {
            Err(why) => {
                self.counters.failed.fetch_add(1, Ordering::Relaxed);
                let error = ModelError::new(Stage::Parse, why);
                manifest.unreadable.push(Failure { id: member.id, hash: None, error });
                true
            }
            Ok(bytes) => {
                manifest.models.push((member.id.clone(), hash));
                if self.known.insert(hash) {
                    return self.send(Job::new(number, member.id, hash, bytes.len() as u64), bytes, outbox);
                }
                self.counters.known.fetch_add(1, Ordering::Relaxed);
                true
            }
        }
    }

    fn send(&self, job: Job, bytes: Vec<u8>, outbox: &Sender<Parcel<Vec<u8>>>) -> bool {
        self.budget.take(job.bytes, &|| self.bench.memory());
        if self.stop.load(Ordering::Relaxed) {
            // Told while it waited for room: this model has not set out.
            self.budget.give_back(job.bytes);
            return false;
        }
        job.take_over(&bytes);
        let job = Arc::new(job);
        self.bench.enter(&job);
        outbox.send(Parcel { job, load: Ok(bytes) }).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_belongs_to_one_shard() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"].map(|text| text.parse().unwrap()).to_vec();
        for byte in 0..=255 {
            assert_eq!(shards.iter().filter(|shard| shard.owns(&[byte; 32])).count(), 1);
        }
        assert!(["", "1", "0/2", "3/2", "a/b", "1/0", "-1/2"].iter().all(|text| text.parse::<Shard>().is_err()));
    }
}
