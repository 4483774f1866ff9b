//! What earlier runs of a bake have left.

use std::path::{Display, PathBuf};

use nullray::Result;
use nullray::io::sealed::hexadecimal;
use nullray::render::journal::Journal;
use nullray::render::plan::{Plan, Request};

use super::super::console::say;
use super::super::output::{Inputs, Samples};
use super::{Bake, Job, goal};

/// What earlier runs of a bake may have left: finished files, and parts of unfinished ones. They count only if everything they depend on is
/// unchanged.
pub(super) struct Earlier<'a> {
    bake: &'a Bake<'a>,
    samples: Samples,
    /// The numbers of samples that they may have.
    possible: Vec<u32>,
}

impl<'a> Earlier<'a> {
    pub(super) fn new(
        bake: &'a Bake,
        request: &Request,
        plan: &Plan,
        read: &[PathBuf],
    ) -> Earlier<'a> {
        let inputs = Inputs::read(read.get(1..).unwrap_or_default());
        Earlier {
            bake,
            samples: Samples::new(bake.scene, request, &inputs),
            possible: match bake.goal {
                None => vec![plan.film.samples],
                Some(_) => goal::POSSIBLE.to_vec(),
            },
        }
    }

    /// The fingerprint of `job` with this number of samples.
    pub(super) fn sum(&self, job: &Job, count: u32) -> [u8; 32] {
        let (bins, goal) = (&self.bake.bins, self.bake.goal);
        let goal = goal.map_or(String::new(), |goal| goal.to_string());
        // "means": parts of earlier versions have energies of all samples.
        let what = format!("baked means {:?} {bins:?} {count}{goal}", job.surface);
        self.samples.of_sums(&what)
    }

    /// The fingerprint of `job` in its file, if that is of the same work.
    fn done_as(&self, job: &Job) -> Option<[u8; 32]> {
        let found = job.fingerprint()?;
        let mut sums = self.possible.iter().map(|samples| self.sum(job, *samples));
        sums.find(|sum| found == hexadecimal(sum))
    }

    /// The number of samples of the parts of `job` that are kept, if there are any.
    pub(super) fn unfinished(&self, job: &Job) -> Result<Option<u32>> {
        for samples in &self.possible {
            if Journal::open(&job.unfinished(), &self.sum(job, *samples))?.found() > 0 {
                return Ok(Some(*samples));
            }
        }
        Ok(None)
    }

    /// The jobs that are left: of those that are done, and whole, it says so by path and table of sources.
    pub(super) fn left(
        &self,
        jobs: Vec<Job>,
        is_whole: impl Fn(&Job) -> bool,
        said: impl Fn(Display, &str) -> String,
    ) -> Result<Vec<Job>> {
        let is_done = |job: &Job| self.done_as(job).is_some() && is_whole(job);
        let (done, left): (Vec<Job>, _) = jobs.into_iter().partition(is_done);
        for job in &done {
            // A run that ended just after it had written the file has left its parts; those of other work are kept.
            let journal = self.done_as(job);
            let journal = journal.and_then(|sum| Journal::open(&job.unfinished(), &sum).ok());
            journal.map_or(Ok(()), Journal::remove)?;
            let table = job.said("source_table").unwrap_or_default();
            say(self.bake.work.quiet.on, &said(job.path.display(), &table))?;
        }
        Ok(left)
    }
}
