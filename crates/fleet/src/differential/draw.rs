//! Random filters over the parts of a history.

use history::{Archive, Filter, LotSummary, Moment, Part};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Greatest number of parts whose values the filters take.
const KNOWN: u64 = 400;

/// Random numbers, with the runs, parameters and parts from which filters choose.
#[derive(Debug)]
pub(super) struct Draw {
    random: SplitMix64,
    /// Runs of the file.
    pub runs: Vec<LotSummary>,
    /// Parameters of the file.
    pub parameters: Vec<String>,
    parts: Vec<Part>,
}

impl Draw {
    /// Reads runs, parameters and some parts of the file.
    pub fn of(file: &Archive, seed: u64) -> history::Result<Self> {
        let mut parts = Vec::new();
        let all = Filter {
            kind: Some("all".to_owned()),
            ..Filter::default()
        };
        let count = file.count_parts(&all)?;
        for offset in (0..8).map(|n| count * n / 8) {
            parts.extend(file.query(&Filter {
                limit: Some(KNOWN / 8),
                offset: Some(offset),
                ..all.clone()
            })?);
        }
        let random = SplitMix64::seed_from_u64(seed);
        let (runs, parameters) = (file.lots(&all)?, file.parameters()?);
        Ok(Self {
            random,
            runs,
            parameters,
            parts,
        })
    }

    /// Draws a number below `limit`; 0 for a limit of 0.
    pub fn below(&mut self, limit: usize) -> usize {
        (self.random.next_u64() % limit.max(1) as u64) as usize
    }

    /// Draws true with a probability of one in `times`.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// Draws a part of the file; `None` when the file has no parts.
    pub fn part(&mut self) -> Option<Part> {
        let at = self.below(self.parts.len());
        self.parts.get(at).cloned()
    }

    /// Draws a parameter, most often one that parts have; rarely one that does not exist.
    pub fn parameter(&mut self) -> String {
        if self.once_in(40) {
            return "no_such_v".to_owned();
        }
        let measured = self.part().map(|it| it.values).unwrap_or_default();
        let keys = match self.once_in(8) {
            true => self.parameters.clone(),
            false => measured.keys().cloned().collect(),
        };
        let at = self.below(keys.len());
        keys.get(at).cloned().unwrap_or_default()
    }

    /// Draws the name of a lot; rarely one that does not exist.
    pub fn lot(&mut self) -> String {
        let unknown = usize::from(self.once_in(40));
        let at = self.below(self.runs.len() + unknown);
        let known = self.runs.get(at).map(|it| it.lot.clone());
        known.unwrap_or_else(|| "no such lot".to_owned())
    }

    /// Draws a filter by run and time.
    pub fn runs(&mut self) -> Filter {
        let mut filter = Filter {
            lot: self.once_in(2).then(|| self.lot()),
            ..Filter::default()
        };
        if self.once_in(6) {
            filter.run = Some(1 + self.below(3) as u32);
        }
        if self.once_in(6) {
            filter.recipe = self.part().map(|it| it.recipe);
        }
        if self.once_in(4) {
            filter.since = self.part().map(|it| it.time);
        }
        if self.once_in(4) {
            let later = self.below(3) as i64;
            filter.until = self.part().map(|it| Moment(it.time.0 + later));
        }
        filter
    }

    /// Draws a filter by run, time and part.
    pub fn parts(&mut self) -> Filter {
        let mut filter = self.runs();
        let Some(like) = self.part() else {
            return filter;
        };
        if self.once_in(3) {
            filter.verdict = Some(like.verdict.clone());
        }
        if self.once_in(6) {
            filter.bin.clone_from(&like.bin);
        }
        if self.once_in(12) {
            filter.serial.clone_from(&like.serial);
        }
        if self.once_in(4) {
            let kind = ["lot", "golden", "all"][self.below(3)];
            filter.kind = Some(kind.to_owned());
        }
        filter.suspect = self.once_in(8);
        if self.once_in(2) {
            self.range(&mut filter, &like);
        }
        self.page(&mut filter);
        filter
    }

    /// Adds a range of values. Its ends are values of parts, to check that an end belongs to the range.
    fn range(&mut self, filter: &mut Filter, like: &Part) {
        let param = self.parameter();
        let value = |part: &Part| part.values.get(&param).and_then(serde_json::Value::as_f64);
        let other = self.part();
        let ends = [value(like), other.as_ref().and_then(value)];
        let [low, high] = match ends {
            [Some(a), Some(b)] => [Some(a.min(b)), Some(a.max(b))],
            other => other,
        };
        filter.min = low.filter(|_| !self.once_in(3));
        filter.max = high.filter(|_| !self.once_in(3));
        if let (Some(min), Some(max)) = (filter.min, filter.max)
            && min > max
        {
            filter.max = None;
        }
        filter.param = Some(param);
    }

    fn page(&mut self, filter: &mut Filter) {
        if self.once_in(3) {
            filter.limit = Some(self.below(60) as u64);
        }
        if self.once_in(6) {
            filter.offset = Some(self.below(30) as u64);
        }
    }
}
