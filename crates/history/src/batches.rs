//! Batches of parts that were tested together in a chamber: curves of the air, and when the contact in each socket
//! switched. Curves are packed as [`CurveRecord`] describes. A server with many rigs has no batches.

use super::curve::{packed, unpacked};
use super::error::{Doing, HistoryError, Result};
use super::insert::signed;
use super::source::{Dialect, Read, Row};
use super::store::RowIds;
use super::{Archive, CurveRecord, Filter, Moment};
use rusqlite::types::Value;
use rusqlite::{OptionalExtension, Transaction, params};
use serde::Serialize;
use std::str::FromStr;
use utoipa::ToSchema;

/// Prefix of the signal of a socket; the number of the socket follows.
const SOCKET: &str = "socket_";

/// A batch whose test has ended.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BatchRecord {
    /// Name of the lot, of which a run is open.
    pub lot: String,
    /// Number of the batch in its run, from 1.
    pub number: u64,
    /// Time zero of the curves.
    pub begin_us: i64,
    /// End of the test: the time of the verdicts.
    pub ended_us: i64,
    /// Signals, each name at most once: `set_point`, `reference` (C), `rate` (K/min), and for each socket `socket_`
    /// with its number: 1 when the contact opened, 0 when the contact closed.
    pub signals: Vec<BatchSignal>,
}

/// A signal of a batch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BatchSignal {
    /// Number of the part in the socket; `None` for the chamber.
    pub seq: Option<u64>,
    /// Samples of the signal.
    pub curve: CurveRecord,
}

/// A batch, as pages and papers show it. Times of its curves are seconds since `begin`.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Batch {
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
    /// Number of the batch in its run.
    pub number: u64,
    /// Time zero of the curves.
    pub begin: Moment,
    /// End of the test.
    pub ended: Moment,
    /// Temperature of the air in the chamber.
    pub curve: BatchAir,
    /// Sockets whose contact has switched.
    pub switched: Vec<BatchSocket>,
}

/// Temperature of the air during a batch; the members have equal lengths.
#[derive(Debug, Clone, PartialEq, Default, Serialize, ToSchema)]
pub struct BatchAir {
    /// Time since the begin of the batch, s.
    pub t_s: Vec<f64>,
    /// Set point of the chamber, C; null before its first ramp.
    pub set_c: Vec<Option<f64>>,
    /// Reading of the reference thermometer, C.
    pub reference_c: Vec<Option<f64>>,
    /// Slope of the reference thermometer over a minute, K/min; null in the first minute.
    pub rate_k_per_min: Vec<Option<f64>>,
}

/// Times at which the contact of a socket switched; of each kind, at most the last twelve.
#[derive(Debug, Clone, PartialEq, Default, Serialize, ToSchema)]
pub struct BatchSocket {
    /// Number of the socket.
    pub socket: u16,
    /// Number of the part; null for a part without a number.
    pub seq: Option<u64>,
    /// Times at which the contact opened, s.
    pub opened_s: Vec<f64>,
    /// Times at which the contact closed, s.
    pub closed_s: Vec<f64>,
}

/// Inserts a batch; does nothing when the batch is stored already.
pub(super) fn insert(tx: &Transaction<'_>, row_ids: &RowIds, it: &BatchRecord) -> Result<()> {
    const DOING: &str = "recording a batch";
    assert!(it.begin_us <= it.ended_us, "a batch that ends first");
    assert!(it.number > 0, "a batch without its number");
    let run = row_ids.run(&it.lot)?;
    let number = signed("the number of a batch", it.number)?;
    let add = "INSERT INTO batch (run_id, number, begin_us, ended_us) VALUES (?1, ?2, ?3, ?4)
        ON CONFLICT (run_id, number) DO NOTHING RETURNING id";
    let row = tx.query_row(add, params![run, number, it.begin_us, it.ended_us], |row| {
        row.get(0)
    });
    let Some(row) = row.optional().doing(DOING)? else {
        return Ok(());
    };
    it.signals
        .iter()
        .try_for_each(|signal| insert_signal(tx, row, signal))
        .doing(DOING)
}

fn insert_signal(tx: &Transaction<'_>, batch: i64, it: &BatchSignal) -> rusqlite::Result<()> {
    let BatchSignal { seq, curve } = it;
    let is_of_socket = curve.signal.starts_with(SOCKET);
    assert!(
        is_of_socket || seq.is_none(),
        "a part in the air of the chamber"
    );
    let Some((begin_us, _)) = curve.samples.first() else {
        return Ok(());
    };
    assert!(curve.step > 0.0, "{}: a step of 0", curve.signal);
    tx.prepare_cached(
        "INSERT INTO batch_curve (batch_id, signal, seq, unit, step, begin_us, samples, packed)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
    )?
    .execute(params![
        batch,
        curve.signal,
        seq.map(|it| i64::try_from(it).unwrap_or(i64::MAX)),
        curve.unit,
        curve.step,
        begin_us,
        curve.samples.len() as i64,
        packed(curve)
    ])?;
    Ok(())
}

/// Selects the signals of one batch.
pub(super) const SIGNALS: &str = "SELECT signal, seq, step, begin_us, samples, packed
    FROM batch_curve WHERE batch_id = ?";

/// A signal as the file stores it; times are seconds since the start of the batch.
struct Signal {
    name: String,
    seq: Option<u64>,
    samples: Vec<(f64, Option<f64>)>,
}

impl Archive {
    /// Returns the batches that lot, recipe and run of the filter select, in order of run and number; none on a server.
    pub fn batches(&self, filter: &Filter) -> Result<Vec<Batch>> {
        const DOING: &str = "reading the batches";
        if self.source.dialect() == Dialect::Server {
            return Ok(Vec::new());
        }
        let mut select = filter.runs();
        select.sql = format!(
            "SELECT batch.id, lot.name, run.number, batch.number, batch.begin_us, batch.ended_us
             FROM batch JOIN run ON run.id = batch.run_id JOIN lot ON lot.id = run.lot_id
             WHERE batch.run_id IN ({}) ORDER BY batch.run_id, batch.number",
            select.sql
        );
        let found = select.rows(&self.source, |row| {
            let batch = Batch {
                lot: row.get(1)?,
                run: row.get(2)?,
                number: row.get::<i64>(3)?.unsigned_abs(),
                begin: Moment(row.get(4)?),
                ended: Moment(row.get(5)?),
                curve: BatchAir::default(),
                switched: Vec::new(),
            };
            Ok((row.get::<i64>(0)?, batch))
        });
        let mut batches = Vec::new();
        for (row, mut batch) in found.doing(DOING)? {
            let begin_us = batch.begin.0;
            let of_batch = [Value::Integer(row)];
            let signals = self
                .source
                .rows(SIGNALS, &of_batch, |row| self.signal(row, begin_us));
            for signal in signals.doing(DOING)? {
                batch.take(signal?);
            }
            batch.switched.sort_by_key(|it| it.socket);
            batches.push(batch);
        }
        Ok(batches)
    }

    /// Returns the batch in which a part was judged; `None` for a part that was tested alone.
    pub fn batch_of(&self, part: &super::Part) -> Result<Option<Batch>> {
        let of_run = Filter {
            lot: Some(part.lot.clone()),
            run: Some(part.run),
            ..Filter::default()
        };
        let mut batches = self.batches(&of_run)?.into_iter();
        let has_part = |it: &Batch| (it.begin..=it.ended).contains(&part.time);
        Ok(batches.find(has_part))
    }

    fn signal(&self, row: &Row<'_>, begin_us: i64) -> Read<Result<Signal>> {
        let name: String = row.get(0)?;
        let (step, from_us, samples): (f64, i64, i64) = (row.get(2)?, row.get(3)?, row.get(4)?);
        let bytes: Vec<u8> = row.get(5)?;
        let whole = unpacked(&bytes, usize::try_from(samples).unwrap_or(0), step);
        let Some((t_us, values)) = whole else {
            return Ok(Err(HistoryError::Damaged {
                path: self.path.clone(),
                finding: format!("the curve {name:?} does not hold {samples} samples"),
            }));
        };
        let since_s = |t_us: i64| (from_us - begin_us + t_us) as f64 / 1e6;
        Ok(Ok(Signal {
            name,
            seq: row.get::<Option<i64>>(1)?.map(i64::unsigned_abs),
            samples: t_us.into_iter().map(since_s).zip(values).collect(),
        }))
    }
}

impl Batch {
    /// Stores the samples of a signal in the member of its name; ignores an unknown name.
    fn take(&mut self, signal: Signal) {
        let values = || signal.samples.iter().map(|(_, value)| *value).collect();
        match signal.name.as_str() {
            "set_point" => self.curve.set_c = values(),
            "reference" => {
                self.curve.t_s = signal.samples.iter().map(|(t_s, _)| *t_s).collect();
                self.curve.reference_c = values();
            }
            "rate" => self.curve.rate_k_per_min = values(),
            name => {
                let number = name.strip_prefix(SOCKET).map(u16::from_str);
                if let Some(Ok(socket)) = number {
                    self.switched.push(signal.switched(socket));
                }
            }
        }
    }
}

impl Signal {
    fn switched(&self, socket: u16) -> BatchSocket {
        let at = |state: f64| {
            let own = |(_, value): &&(f64, Option<f64>)| *value == Some(state);
            self.samples
                .iter()
                .filter(own)
                .map(|(t_s, _)| *t_s)
                .collect()
        };
        BatchSocket {
            socket,
            seq: self.seq,
            opened_s: at(1.0),
            closed_s: at(0.0),
        }
    }
}
