//! What the test of a part has recorded of a characteristic, whatever its kind.

use crate::dut::Characteristic;
use crate::gauge::Reading;
use crate::handling::wants::Judged;
use crate::rig::sample::Origin;

/// Result: the mean of its repetitions.
pub fn result(judged: &Judged, of: Characteristic) -> Option<Reading> {
    match of {
        Characteristic::EmRelay(parameter) => judged.record.result(parameter),
    }
}

/// The result when it is a number with a finite uncertainty.
pub fn usable(judged: &Judged, of: Characteristic) -> Option<Reading> {
    result(judged, of).filter(Reading::is_usable)
}

/// How often it was measured.
pub fn attempts(judged: &Judged, of: Characteristic) -> usize {
    match of {
        Characteristic::EmRelay(parameter) => judged.record.attempts(parameter),
    }
}

/// Replies behind it, in the order they came.
pub fn evidence(judged: &Judged, of: Characteristic) -> impl Iterator<Item = &Origin> {
    match of {
        Characteristic::EmRelay(parameter) => judged.record.evidence(parameter),
    }
}
