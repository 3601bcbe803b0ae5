//! The person who unloads and loads the rack.
//!
//! The person acts while the door is closed and unlocked. With the lamp `unload` on, they take all parts out. With an
//! empty rack and neither `testing` nor `unload` on, they fill the sockets from the lot. Each of the two takes half of
//! `loading_min`, with the door open.

use super::table::LoadingTable;

/// Task of the person.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// Takes all parts out.
    Unload,
    /// Puts new parts in.
    Load,
}

/// Signals and parts that the person sees.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    /// True when the lock lets the door open.
    pub unlocked: bool,
    /// True while lamp `testing` is on.
    pub testing: bool,
    /// True while lamp `unload` is on.
    pub unload: bool,
    /// True when parts are in the rack.
    pub rack_filled: bool,
    /// True when parts of the lot are outside the rack.
    pub parts_wait: bool,
}

/// The person with their present task.
#[derive(Debug, Clone)]
pub struct Person {
    table: LoadingTable,
    task: Option<(Task, u64)>,
}

impl Person {
    /// Creates a person at rest.
    pub fn new(table: LoadingTable) -> Self {
        Self { table, task: None }
    }

    /// Checks whether the person has the door open at `now_us`.
    pub fn at_door(&self, now_us: u64) -> bool {
        self.task
            .is_some_and(|(_, since_us)| now_us >= self.opens_us(since_us))
    }

    /// Starts, drops or finishes a task; returns the task that has just been finished.
    pub fn step(&mut self, now_us: u64, sight: &Sight) -> Option<Task> {
        let Some((task, since_us)) = self.task else {
            self.task = wanted(sight).map(|task| (task, now_us));
            return None;
        };
        let opens_us = self.opens_us(since_us);
        if now_us < opens_us && wanted(sight) != Some(task) {
            self.task = None;
        }
        let end_us = opens_us + (self.table.loading_min * 30e6) as u64;
        let done = self.task.filter(|_| now_us >= end_us);
        if done.is_some() {
            self.task = None;
        }
        done.map(|(task, _)| task)
    }

    fn opens_us(&self, since_us: u64) -> u64 {
        since_us + (self.table.reaction_s * 1e6) as u64
    }
}

fn wanted(sight: &Sight) -> Option<Task> {
    if !sight.unlocked {
        None
    } else if sight.unload {
        sight.rack_filled.then_some(Task::Unload)
    } else {
        let load = !sight.rack_filled && sight.parts_wait && !sight.testing;
        load.then_some(Task::Load)
    }
}
