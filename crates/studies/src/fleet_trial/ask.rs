//! Measures how long a database with many made-up rigs takes to answer questions.

use super::super::figure::{Bar, Figure};
use super::super::order::Order;
use super::{timed, wait};
use app::progress::{PIECES, progress};
use fleet::generate::{VALUES, Wanted, generate};
use fleet::trial::Trial;
use fleet::{Reader, Rigs, set_up};
use history::inquiry::shifts::{Shift, by_shift};
use history::{Archive, Filter, Moment};
use jiff::tz::TimeZone;
use quality::Ordered;
use std::path::Path;
use tokio::runtime::Runtime;

/// Days over which the parts are spread.
const DAYS: i64 = 365;
/// Number of questions of each kind.
const ASKED: u64 = 60;
const DAY_US: i64 = 86_400_000_000;

/// Makes the figures about the database and about the questions.
pub(super) fn figures(
    server: &Trial,
    runtime: &Runtime,
    order: &Order,
) -> anyhow::Result<[Vec<Figure>; 2]> {
    let target = server.owner();
    wait(runtime, set_up(&target))?;
    let wanted = Wanted {
        parts: (order.parts * order.lots).cast_signed(),
        rigs: order.lots.cast_signed(),
        days: DAYS,
    };
    let bar = progress(Some(wanted.parts.unsigned_abs()), PIECES);
    let made = |parts: i64| bar.set_position(parts.unsigned_abs());
    let (filled, seconds) = timed(|| wait(runtime, generate(&target, wanted, made)));
    filled?;
    bar.finish_and_clear();
    let parts = wanted.parts.unsigned_abs();
    let rows = (wanted.parts * VALUES) as f64;
    let bytes = size(&server.data())? as f64 / parts as f64;
    let database = vec![
        Figure::new("measurement rows", parts, Some(rows), ""),
        Figure::new("made up", parts, Some(rows / seconds), "rows/s"),
        Figure::new(
            "data of a part, 25 measurements, indexes included",
            parts,
            Some(bytes),
            "bytes",
        ),
    ];
    let all = Archive::of_server(Box::new(Reader::open(&target, &Rigs::default())?));
    let of_rig = |n: u64| {
        let rig = format!("rig-{:03}", 1 + n % order.lots);
        let (site, rig) = (None, Some(rig));
        let reader = Reader::open(&target, &Rigs { site, rig })?;
        anyhow::Ok(Archive::of_server(Box::new(reader)))
    };
    let questions = vec![
        filters(of_rig, order)?.bar(Bar::AtMost(100.0)),
        months(&all)?.bar(Bar::AtMost(300.0)),
        lives(&all, order)?.bar(Bar::AtMost(20.0)),
    ];
    Ok([database, questions])
}

/// Times filters by rig, lot, verdict and range of a value.
fn filters(
    of_rig: impl Fn(u64) -> anyhow::Result<Archive>,
    order: &Order,
) -> anyhow::Result<Figure> {
    let mut times = Vec::new();
    let mut found = 0;
    for n in 0..ASKED {
        let archive = of_rig(n * 7919)?;
        let lots = archive.lots(&Filter {
            lot: Some(format!("L-{}-1", 1 + n * 7919 % order.lots)),
            ..Filter::default()
        })?;
        let filter = Filter {
            lot: lots.first().map(|it| it.lot.clone()),
            verdict: Some(["fail", "pass"][(n % 2) as usize].to_owned()),
            param: Some(format!("made_up_{}_v", 1 + n % 25)),
            min: Some(7.0),
            max: Some([9.0, 7.02][(n % 2) as usize]),
            ..Filter::default()
        };
        let (parts, seconds) = timed(|| archive.query(&filter));
        found += parts?.len();
        times.push(1e3 * seconds);
    }
    let each = found as f64 / ASKED as f64;
    Ok(
        quantiles("filter by rig, lot, verdict and range, p95", &times)
            .with("parts_each", Some(each)),
    )
}

/// Times questions for the yield of a month by rig and day.
fn months(all: &Archive) -> anyhow::Result<Figure> {
    let now_us = jiff::Timestamp::now().as_microsecond();
    let day = [Shift {
        name: "day".to_owned(),
        minutes: (0, 24 * 60),
    }];
    let mut times = Vec::new();
    let mut counted = 0;
    for month in 1..=10 {
        let until = now_us - month * 30 * DAY_US;
        let filter = Filter {
            since: Some(Moment(until - 30 * DAY_US)),
            until: Some(Moment(until)),
            ..Filter::default()
        };
        let (rows, seconds) = timed(|| by_shift(all, &filter, &day, &TimeZone::UTC));
        counted = rows?.iter().map(|it| it.counts.parts).sum();
        times.push(1e3 * seconds);
    }
    Ok(quantiles("yield by rig and day of a month, p95", &times)
        .with("parts_each", Some(counted as f64)))
}

/// Times reading all tests of a serial number, down to the values.
fn lives(all: &Archive, order: &Order) -> anyhow::Result<Figure> {
    let mut times = Vec::new();
    for n in 0..ASKED {
        let (rig, part) = (1 + n * 7919 % order.lots, 1 + n * 104_729 % order.parts);
        let (life, seconds) = timed(|| all.of_serial(&format!("S-{rig}-{part}")));
        anyhow::ensure!(life?.len() == 1, "a serial number without its part");
        times.push(1e3 * seconds);
    }
    Ok(quantiles("life of a serial number, p95", &times))
}

fn quantiles(name: &str, times: &[f64]) -> Figure {
    let ordered = Ordered::of(times);
    Figure::new(name, times.len() as u64, ordered.quantile(0.95), "ms")
        .with("median", ordered.quantile(0.5))
        .with("worst", ordered.quantile(1.0))
}

/// Returns the size of the server's tables, bytes: that of its data folder without the log of transactions.
fn size(data: &Path) -> anyhow::Result<u64> {
    let mut bytes = 0;
    for entry in std::fs::read_dir(data.join("base"))? {
        for file in std::fs::read_dir(entry?.path())? {
            bytes += file?.metadata()?.len();
        }
    }
    Ok(bytes)
}
