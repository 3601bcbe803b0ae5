//! Curves kept as evidence of a reject: packs the samples of a signal into a blob, and unpacks it. Only a part that did
//! not pass keeps its curves; those of all parts would fill 20 GB a year.
//!
//! A sample is two LEB128 numbers (seven bits per byte, low ones first, the high bit set in all bytes but the last):
//!
//! 1. microseconds since the previous sample, 0 for the first one;
//! 2. 0 for a reading without a number (over range), else 1 + the zigzag code (0, -1, 1, -2 ...) of the change in steps
//!    since the last number; the first number counts from 0.
//!
//! A sample takes 2 to 12 bytes (gaps below nine hours, changes below 2^47 steps), about 4 in a test by the default
//! recipe. A part takes at most 12 kB, because a test keeps at most
//! [`MAX_SAMPLES`](machine::instrument::trace::MAX_SAMPLES) samples; with a digitizer, at most 156 kB, because the test
//! keeps [`MAX_WAVE_SAMPLES`](machine::instrument::trace::MAX_WAVE_SAMPLES) samples of waveforms beside them.

use super::Moment;
use super::error::{Doing, HistoryError, Result};
use super::source::{Read, Row};
use super::{Archive, Part};
use machine::instrument::curve::Curve;
use rusqlite::types::Value;
use rusqlite::{Transaction, params};
use serde::{Deserialize, Serialize, Serializer};
use utoipa::ToSchema;

/// Samples of one signal during a test.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CurveRecord {
    /// Name of the point that was sampled.
    pub signal: String,
    /// Unit of the values; empty for bits and counts.
    pub unit: String,
    /// Resolution, in the unit of the values, above 0: the file stores each value as a whole number of steps.
    pub step: f64,
    /// Instant (microseconds since 1970 UTC) and value, in order of time; the value is `None` for a reading over range.
    pub samples: Vec<(i64, Option<f64>)>,
}

/// A curve as JSON shows it.
#[derive(Serialize, ToSchema)]
#[schema(as = Curve)]
pub(super) struct Shown<'a> {
    /// Name of the point that was sampled.
    signal: &'a str,
    /// Unit of the values; empty for bits and counts.
    unit: &'a str,
    /// Instant of the first sample.
    begin: Moment,
    /// Time of each sample since `begin`, microseconds.
    t_us: &'a [i64],
    /// Value of each sample; null for a reading over range.
    values: &'a [Option<f64>],
}

/// Serialises curves for JSON, with their start as a date and time.
pub(super) fn shown<S: Serializer>(
    curves: &[Curve],
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_seq(curves.iter().map(|it| Shown {
        signal: &it.signal,
        unit: &it.unit,
        begin: Moment(it.begin_us),
        t_us: &it.t_us,
        values: &it.values,
    }))
}

/// Packs the samples of a curve into a blob.
pub(super) fn packed(curve: &CurveRecord) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(curve.samples.len() * 5);
    let (mut then, mut before) = (curve.samples.first().map_or(0, |it| it.0), 0_i64);
    for &(at, value) in &curve.samples {
        number(&mut bytes, at.saturating_sub(then).max(0).unsigned_abs());
        then = then.max(at);
        match value.filter(|it| it.is_finite()) {
            None => number(&mut bytes, 0),
            Some(value) => {
                let steps = (value / curve.step).round() as i64;
                number(&mut bytes, 1 + zigzag(steps.wrapping_sub(before)));
                before = steps;
            }
        }
    }
    bytes
}

/// Unpacks a blob into time offsets and values; `None` unless it holds exactly `samples` of them.
pub(super) fn unpacked(
    mut bytes: &[u8],
    samples: usize,
    step: f64,
) -> Option<(Vec<i64>, Vec<Option<f64>>)> {
    let (mut at, mut steps) = (0_i64, 0_i64);
    let (mut offsets, mut values) = (Vec::new(), Vec::new());
    while !bytes.is_empty() {
        at = at.checked_add_unsigned(take(&mut bytes)?)?;
        offsets.push(at);
        values.push(match take(&mut bytes)? {
            0 => None,
            code => {
                steps = steps.wrapping_add(straight(code - 1));
                Some(steps as f64 * step)
            }
        });
    }
    (offsets.len() == samples).then_some((offsets, values))
}

fn number(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

fn take(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0_u64;
    for shift in (0..64).step_by(7) {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= u64::from(byte & 0x7f).checked_shl(shift)?;
        if byte < 0x80 {
            return Some(value);
        }
    }
    None
}

/// Zigzag code: maps integers near 0, of either sign, to small unsigned ones.
fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)).cast_unsigned()
}

fn straight(code: u64) -> i64 {
    (code >> 1).cast_signed() ^ -((code & 1).cast_signed())
}

/// Inserts a curve; does nothing for a curve without samples.
pub(super) fn insert(tx: &Transaction<'_>, part: i64, it: &CurveRecord) -> rusqlite::Result<()> {
    let Some((begin_us, _)) = it.samples.first() else {
        return Ok(());
    };
    assert!(it.step > 0.0, "{}: a step of 0", it.signal);
    tx.prepare_cached(
        "INSERT INTO curve (part_id, signal, unit, step, begin_us, samples, packed)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
    )?
    .execute(params![
        part,
        it.signal,
        it.unit,
        it.step,
        begin_us,
        it.samples.len() as i64,
        packed(it)
    ])?;
    Ok(())
}

/// Selects the curves of one part.
pub(super) const CURVES: &str = "SELECT signal, unit, begin_us, step, samples, packed FROM curve
    WHERE part_id = ? ORDER BY signal";

impl Archive {
    /// Returns the curves of a part in order of signal names; a part that passed has none.
    pub fn curves(&self, part: &Part) -> Result<Vec<Curve>> {
        const DOING: &str = "reading the curves of a part";
        let of_part = [Value::Integer(part.row)];
        let curves = self.source.rows(CURVES, &of_part, |row| self.curve(row));
        curves.doing(DOING)?.into_iter().collect()
    }

    fn curve(&self, row: &Row<'_>) -> Read<Result<Curve>> {
        let (step, samples): (f64, i64) = (row.get(3)?, row.get(4)?);
        let bytes: Vec<u8> = row.get(5)?;
        let signal: String = row.get(0)?;
        let whole = unpacked(&bytes, usize::try_from(samples).unwrap_or(0), step);
        let Some((t_us, values)) = whole else {
            return Ok(Err(HistoryError::Damaged {
                path: self.path.clone(),
                finding: format!("the curve {signal:?} does not hold {samples} samples"),
            }));
        };
        Ok(Ok(Curve {
            signal,
            unit: row.get(1)?,
            begin_us: row.get(2)?,
            t_us,
            values,
        }))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use machine::instrument::trace::{MAX_SAMPLES, MAX_WAVE_SAMPLES};

    /// Largest number of bytes that a sample takes: a gap below 2^35 us takes 5, a change of less than 2^47 steps 7.
    const WORST: usize = 5 + 7;

    fn curve(samples: &[(i64, Option<f64>)]) -> CurveRecord {
        CurveRecord {
            signal: "voltage".into(),
            unit: "V".into(),
            step: 1e-4,
            samples: samples.to_vec(),
        }
    }

    #[test]
    fn samples_keep_the_microsecond_and_half_a_step() {
        let samples = [
            (1_700_000_000_000_000, Some(0.0)),
            (1_700_000_000_000_000, None),
            (1_700_000_000_004_321, Some(-7.123_449)),
            (1_700_000_034_004_321, Some(9.999_96)),
        ];
        let bytes = packed(&curve(&samples));
        let (at, values) = unpacked(&bytes, 4, 1e-4).unwrap();
        assert_eq!(at, [0, 0, 4_321, 34_004_321]);
        for (value, (_, was)) in values.iter().zip(samples) {
            match (value, was) {
                (Some(value), Some(was)) => assert!((value - was).abs() <= 0.5e-4 + 1e-12),
                (value, was) => assert_eq!((*value, was), (None, None)),
            }
        }
    }

    #[test]
    fn a_blob_of_another_length_is_no_curve() {
        let bytes = packed(&curve(&[(0, Some(1.0)), (5_000, Some(1.5)), (9_000, None)]));
        assert!(unpacked(&bytes, 3, 1e-4).is_some());
        for length in 0..bytes.len() {
            assert!(unpacked(&bytes[..length], 3, 1e-4).is_none(), "{length}");
        }
        assert!(unpacked(&bytes, 4, 1e-4).is_none());
        assert!(unpacked(&[0xff; 11], 1, 1e-4).is_none());
    }

    #[test]
    fn no_sample_takes_more_than_the_worst() {
        let nine_hours_us = (1 << 35) - 1;
        let far = f64::from(u32::MAX) * 1e-4 * 16_384.0;
        let bytes = packed(&curve(&[
            (0, Some(far)),
            (nine_hours_us, Some(-far)),
            (2 * nine_hours_us, Some(far)),
        ]));
        assert!(bytes.len() <= 3 * WORST, "{} bytes", bytes.len());
        const { assert!(MAX_SAMPLES * WORST <= 12_000) };
        const { assert!((MAX_SAMPLES + MAX_WAVE_SAMPLES) * WORST <= 156_000) };
    }

    #[test]
    fn every_whole_number_has_one_code() {
        for value in [0, 1, -1, 63, -64, i64::MAX, i64::MIN] {
            assert_eq!(straight(zigzag(value)), value);
        }
        assert_eq!([0, -1, 1, -2].map(zigzag), [0, 1, 2, 3]);
    }
}
