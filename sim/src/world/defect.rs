//! Distribution of defects over a lot.

use super::draw::{Draw, Subject};

/// Returns the defect of a lot part, if any. Each block of (kinds / rate) parts contains every kind once, at a place
/// that the seed draws; `rate_pct` is in percent.
pub fn of_part<D: Copy>(kinds: &[D], seed: u64, index: u64, rate_pct: f64) -> Option<D> {
    if rate_pct <= 0.0 {
        return None;
    }
    let count = kinds.len() as u64;
    let block = ((count as f64 * 100.0 / rate_pct).round() as u64).max(count);
    let mut draw = Draw::new(seed, Subject::DefectBlock, index / block);
    let mut taken: Vec<u64> = Vec::with_capacity(kinds.len());
    for &defect in kinds {
        let mut place = draw.below(block);
        while taken.contains(&place) {
            place = (place + 1) % block;
        }
        if place == index % block {
            return Some(defect);
        }
        taken.push(place);
    }
    None
}
