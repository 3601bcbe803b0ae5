//! The test of a batch under way: its turns, its troubles, and verdict and list of each part at its end.

use super::{BatchTurn, Phase};
use crate::dut::batch::{BatchProgress, BatchTest, SocketResult};
use crate::handling::output::Judged;
use crate::handling::place::Place;
use crate::handling::trouble::Trouble;
use crate::instrument::act::JobDone;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::{RigTime, Second};

/// Advances the test; returns the next phase once every part is judged.
pub(super) fn advance(
    turn: &mut BatchTurn,
    since: RigTime,
    test: &mut dyn BatchTest,
    done: Option<&JobDone>,
) -> Option<Phase> {
    if turn.input(DigitalIn::DoorLocked) == Some(false) {
        turn.trouble.push(Trouble::DoorNotLocked);
    }
    let took = turn.now.since(since);
    if took > test.longest() {
        turn.trouble.push(Trouble::TooLong("testing", took));
    }
    match test.step(turn.now, done, turn.image) {
        BatchProgress::Running(state) => {
            turn.run(&state);
            None
        }
        BatchProgress::Judged(outcome) => {
            let troubles = outcome.troubles.into_iter().map(Trouble::Batch);
            turn.trouble.extend(troubles);
            judged(turn, outcome.results);
            turn.parts.found = outcome.found;
            Some(Phase::Cooling {
                since: turn.now,
                reported: false,
            })
        }
    }
}

/// Gives each part its verdict and its list.
fn judged(turn: &mut BatchTurn, results: Vec<SocketResult>) {
    for result in results {
        let now = turn.now;
        let Some(part) = turn.ledger.part_mut(Place::Socket(result.socket)) else {
            panic!("a result for the empty socket {}", result.socket);
        };
        part.test = part.probed_at.map(|at| Second(now.since(at).as_seconds()));
        if let Some(why) = part.why_untested() {
            part.bin = Some(Bin::RETEST);
            let untested = Judged::untested(part.clone(), why, now);
            turn.parts.judged.push(untested);
            continue;
        }
        part.bin = Some(result.verdict.bin());
        turn.parts.judged.push(Judged {
            part: part.clone(),
            verdict: result.verdict,
            judgements: result.judgements,
            record: result.record,
            at: now,
        });
    }
    let mut left = turn.ledger.each().filter_map(|(_, part)| part);
    assert!(
        left.all(|part| part.bin.is_some()),
        "a part without a result"
    );
}
