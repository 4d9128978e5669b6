//! The job `sweep`: a design at every point of a grid, each on disk as soon as it is computed.
//!
//! The exception to jobs that compute in memory and leave writing to their caller: what took hours must outlive the process.

use super::design::design_from;
use super::design_outcome::ControllerFile;
use super::sweep_outcome::{PointDesign, PointFile, PointResult, PointStamp, SweepStatus};
use super::{Envelope, Input, StudyError, SweepDirectory, SweepPlan};
use crate::files::FileError;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Stack of a worker, as large as the main thread's is elsewhere.
const STACK_BYTES: usize = 8 << 20;

/// A share of a sweep: part `number` (from 1) of `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1 …
    pub number: usize,
    /// … to this.
    pub of: usize,
}

impl Default for Shard {
    fn default() -> Self {
        Shard { number: 1, of: 1 }
    }
}

/// How far a sweep is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SweepProgress {
    /// Points that are there.
    pub done: usize,
    /// Those of them that were there at the beginning.
    pub found: usize,
    /// Points of the shard.
    pub total: usize,
}

/// Computes those points of a shard that the directory does not have; a chain of points that begin from each other is
/// computed in order by one worker, so that neither workers, shards nor interruptions change a number.
///
/// # Errors
/// A point's file that is of another sweep, an input that changed on the way, the system's. A point that has no controller is no
/// error: its file says why.
pub fn sweep(
    plan: &SweepPlan,
    directory: &SweepDirectory,
    jobs: usize,
    shard: Shard,
    progress: &(dyn Fn(SweepProgress) + Sync),
) -> Result<(), StudyError> {
    let mine = |(k, _): &(usize, Range<usize>)| k % shard.of.max(1) == shard.number.saturating_sub(1);
    let chains: Vec<Range<usize>> =
        plan.chains().into_iter().enumerate().filter(mine).map(|(_, c)| c).collect();
    let present = directory.present();
    for index in &present {
        directory.read(*index)?;
    }
    let total = chains.iter().map(ExactSizeIterator::len).sum();
    let found = chains.iter().flat_map(Clone::clone).filter(|k| present.contains(k)).count();
    let left: Vec<&Range<usize>> =
        chains.iter().filter(|c| (*c).clone().any(|k| !present.contains(&k))).collect();
    let (next, done, stop) = (AtomicUsize::new(0), AtomicUsize::new(found), AtomicBool::new(false));
    let failure: Mutex<Option<StudyError>> = Mutex::new(None);
    progress(SweepProgress { done: found, found, total });
    let work = || {
        while let Some(chain) = left.get(next.fetch_add(1, Ordering::Relaxed)) {
            let mut before: Option<PointFile> = None;
            for index in (*chain).clone() {
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                let point = if present.contains(&index) {
                    directory.read(index)
                } else {
                    let point = compute(plan, directory, index, before.as_ref());
                    point.inspect(|_| {
                        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
                        progress(SweepProgress { done, found, total });
                    })
                };
                match point {
                    Ok(point) => before = Some(point),
                    Err(e) => {
                        *failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(e);
                        stop.store(true, Ordering::Relaxed);
                        return;
                    }
                }
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, left.len().max(1)) {
            let worker = std::thread::Builder::new().stack_size(STACK_BYTES);
            // where the system gives no more threads, those that are there go on
            if worker.spawn_scoped(scope, work).is_err() {
                work();
            }
        }
    });
    failure.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

/// One point: designed, written, and read back, so that what follows from it is what a later run has too.
fn compute(
    plan: &SweepPlan,
    directory: &SweepDirectory,
    index: usize,
    before: Option<&PointFile>,
) -> Result<PointFile, StudyError> {
    let near = before.filter(|b| plan.follows(index, b.outcome.point.index)).and_then(controller);
    let stamp = PointStamp {
        sweep_sha256: directory.file().sha256.clone(),
        index,
        at: plan.points[index].at.clone(),
        started_from: near.and(before).map(|b| b.outcome.point.index),
        sha256: String::new(),
    };
    let design = plan.opened(index);
    // thousands of points have metrics where these are asked for
    let (inputs, result) = match design_from(&design, near, design.metrics) {
        Ok((mut outcome, inputs)) => {
            let own = &plan.points[index].design;
            // names as they are written: the same from wherever the sweep is started
            outcome.design.vehicle.clone_from(&own.vehicle);
            outcome.design.road.clone_from(&own.road);
            outcome.design.start.clone_from(&own.start);
            outcome.why.iter_mut().for_each(|why| *why = plan.written_text(why));
            outcome.notes.iter_mut().for_each(|note| note.text = plan.written_text(&note.text));
            (inputs, PointDesign::Outcome(Box::new(outcome)))
        }
        // of the moment, and not of the point
        Err(e @ StudyError::File(FileError::Read { .. })) => return Err(e),
        Err(e) => {
            let status = if e.is_wrong_input() { SweepStatus::WrongInput } else { SweepStatus::Failed };
            (Vec::new(), PointDesign::None { status, why: plan.written_text(&e.to_string()) })
        }
    };
    let inputs: Vec<Input> = inputs.into_iter().map(|i| Input { path: plan.written(&i.path), ..i }).collect();
    if let Some(changed) = inputs.iter().find(|i| !plan.seal.inputs.contains(i)) {
        let found = format!("{}, whose SHA-256 is {} now", changed.path, changed.sha256);
        let expected = "files that stay as they are while a sweep runs".to_owned();
        return Err(StudyError::Setting { field: "inputs", expected, found });
    }
    let point = Envelope::new("design", inputs, PointResult { point: stamp, result });
    let point = match serde_json::from_str::<PointFile>(&point.to_json()) {
        Ok(read) => read,
        // JSON has no infinities
        Err(e) => {
            let why = format!("its result has a number that is not finite ({e})");
            let result = PointDesign::None { status: SweepStatus::Failed, why };
            Envelope::new("design", Vec::new(), PointResult { point: point.outcome.point, result })
        }
    };
    let point = point.sealed();
    directory.write(&point)?;
    Ok(point)
}

fn controller(point: &PointFile) -> Option<&ControllerFile> {
    match &point.outcome.result {
        PointDesign::Outcome(o) => o.controller.as_ref(),
        PointDesign::None { .. } => None,
    }
}
