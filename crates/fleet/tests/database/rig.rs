//! A rig for tests, which writes its history without a machine.

use config::{FleetSettings, FleetTarget};
use fleet::{Pushed, Result, push};
use history::outbox::Outbox;
use history::{
    AlarmRecord, EnteredResults, HoldReason, InterruptedRecord, LandingRecord, LotRecord, LotState,
    LotStateRecord, MeasurementRecord, Moment, OrderRecord, PartRecord, ReferenceCheckRecord, Row,
    SampleRecord, Store, csv, parse_results, snapshot_hash,
};
use machine::dut::Reason;
use machine::station::catalogue::AlarmCode;
use machine::station::trouble::Alarm;
use std::path::PathBuf;

/// Judgement of the first part: 2026-01-31T23:59:00Z, so that parts lie in two months.
pub const BEGIN_US: i64 = 1_769_903_940_000_000;

/// A rig with a history of its own.
pub struct Rig {
    /// Name of the rig.
    pub name: String,
    /// Path of the history file.
    pub db: PathBuf,
    pub folder: tempfile::TempDir,
}

impl Rig {
    /// Makes a rig without history.
    pub fn new(name: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self {
            name: name.to_owned(),
            db: folder.path().join("history.db"),
            folder,
        }
    }

    /// Records `count` parts of a lot in a run of its own, each with `values` measurements; every tenth fails. Leaves
    /// the last part in the machine.
    pub fn run(&self, lot: &str, count: u64, values: usize) {
        let mut store = Store::open(&self.db).unwrap();
        store.begin_lot(&lot_record(lot)).unwrap();
        let rows: Vec<Row> = (1..=count)
            .map(|seq| Row::Part(part(lot, seq, values)))
            .collect();
        store.record(&rows).unwrap();
        let landed: Vec<Row> = (1..count)
            .map(|seq| Row::Landed(landing(lot, seq)))
            .collect();
        store.record(&landed).unwrap();
        store
            .record(&[Row::Alarm(AlarmRecord {
                lot: Some(lot.to_owned()),
                code: "part_lost".to_owned(),
                text: "a part is lost".to_owned(),
                raised_at_us: BEGIN_US + 1,
                ..AlarmRecord::default()
            })])
            .unwrap();
        store.close_lot(lot, BEGIN_US + 1_000_000_000).unwrap();
    }

    /// Records four parts of a lot, calls `between`, and then notes that the last test was interrupted and another part
    /// landed.
    pub fn cut_off(&self, lot: &str, between: impl FnOnce()) {
        let mut store = Store::open(&self.db).unwrap();
        store.begin_lot(&lot_record(lot)).unwrap();
        let parts: Vec<Row> = (1..=4).map(|seq| Row::Part(part(lot, seq, 3))).collect();
        store.record(&parts).unwrap();
        between();
        let interrupted = Row::Interrupted(InterruptedRecord {
            lot: lot.to_owned(),
            kind: "lot".to_owned(),
            seq: 4,
            reason: Reason::from_text("interrupted: door_open"),
        });
        store
            .record(&[interrupted, Row::Landed(landing(lot, 3))])
            .unwrap();
        store.close_lot(lot, at(9)).unwrap();
    }

    /// Records a retest of a lot with a good and a failed reference check, orders and a hold.
    pub fn gates(&self, lot: &str) {
        let mut store = Store::open(&self.db).unwrap();
        let record = LotRecord {
            retest: Some("wang".to_owned()),
            ..lot_record(lot)
        };
        store.begin_lot(&record).unwrap();
        let alarm = Alarm::from(AlarmCode::ReferenceCheckFailed);
        let check = |at_us, failure| {
            Row::ReferenceCheck(ReferenceCheckRecord {
                lot: lot.to_owned(),
                at_us,
                text: "G-12-1".to_owned(),
                failure,
            })
        };
        let order = |at_us, who: &str, order: &str| {
            Row::Order(OrderRecord {
                lot: Some(lot.to_owned()),
                at_us,
                who: who.to_owned(),
                what: serde_json::json!({ "order": order, "speed": 0.5 }).to_string(),
                ..OrderRecord::default()
            })
        };
        let golden = PartRecord {
            kind: "golden".to_owned(),
            ..part(lot, 1, 3)
        };
        let rows = [
            Row::Part(golden),
            check(at(20), None),
            Row::Part(part(lot, 5, 3)),
            check(at(40), Some(alarm.clone())),
            order(at(41), "li", "start"),
            order(at(42), "zhao", "people"),
            Row::LotState(LotStateRecord {
                lot: lot.to_owned(),
                state: LotState::Held,
                why: Some(HoldReason::Alarm(alarm)),
                at_us: at(43),
            }),
        ];
        rows.iter()
            .for_each(|row| store.record(std::slice::from_ref(row)).unwrap());
        store.close_lot(lot, at(44)).unwrap();
    }

    /// Records a run of a lot that needs results from outside of the rig, and results on two parts and the lot: one passes,
    /// one fails and is corrected, one is undecided.
    pub fn external(&self, lot: &str) {
        let recipe = "[external]\nr_iso_ohm = { low = 1e9 }\ndwv_ua = { high = 10 }\n\
            [decision]\nrule = \"guard_band\"\nslow_repeats = 3\n";
        let mut store = Store::open(&self.db).unwrap();
        let record = LotRecord {
            recipe: "ssr".to_owned(),
            recipe_hash: snapshot_hash(recipe),
            recipe_snapshot: recipe.to_owned(),
            ..lot_record(lot)
        };
        store.begin_lot(&record).unwrap();
        let parts: Vec<Row> = (1..=4).map(|seq| Row::Part(part(lot, seq, 2))).collect();
        store.record(&parts).unwrap();
        store.close_lot(lot, at(9)).unwrap();
        let first = format!(
            "serial,key,value,u\n{lot}-000001,r_iso_ohm,0.30000000000000004e11,4e9\n{lot}-000002,r_iso_ohm,5e8,1e7\n,dwv_ua,9.9,0.2"
        );
        self.enter(lot, &first);
        self.enter(
            lot,
            &format!("serial,key,value,u\n{lot}-000002,r_iso_ohm,3e10,1e9"),
        );
    }

    /// Enters the results of a file.
    pub fn enter(&self, lot: &str, file: &str) {
        let results = parse_results(&csv::read(file).unwrap()).unwrap();
        let entered = Store::open(&self.db)
            .unwrap()
            .enter_results(&EnteredResults {
                lot,
                recipe: None,
                who: "zhao",
                at: Moment(at(60)),
                file_hash: Some(&snapshot_hash(file)),
                results: &results,
            });
        entered.unwrap().unwrap();
    }

    /// Records a run of a lot in which the reference part G-1 is measured, and the good check a second later.
    pub fn reference(&self, lot: &str, seq: u64, volts: f64) {
        let mut store = Store::open(&self.db).unwrap();
        store.begin_lot(&lot_record(lot)).unwrap();
        let mut golden = PartRecord {
            kind: "golden".to_owned(),
            serial: Some("G-1".to_owned()),
            ..part(lot, seq, 1)
        };
        golden.measurements[0].value = Some(volts);
        let check = ReferenceCheckRecord {
            lot: lot.to_owned(),
            at_us: at(seq + 1),
            text: "G-1".to_owned(),
            failure: None,
        };
        store
            .record(&[Row::Part(golden), Row::ReferenceCheck(check)])
            .unwrap();
        store.close_lot(lot, at(seq + 2)).unwrap();
    }

    /// Returns the settings of the rig.
    pub fn settings(&self, target: &FleetTarget) -> FleetSettings {
        FleetSettings {
            site: "suzhou".to_owned(),
            rig: self.name.clone(),
            targets: vec![target.clone()],
            ..FleetSettings::default()
        }
    }

    /// Sends what the target lacks.
    pub async fn push(&self, target: &FleetTarget) -> Result<Pushed> {
        push(&mut self.outbox(), &self.settings(target), target, || false).await
    }

    /// Opens the queue.
    pub fn outbox(&self) -> Outbox {
        Outbox::open(&self.db).unwrap()
    }

    /// Returns a number that the history gives.
    pub fn number(&self, sql: &str) -> i64 {
        let file = rusqlite::Connection::open(&self.db).unwrap();
        file.query_row(sql, [], |row| row.get(0)).unwrap()
    }
}

/// Returns the record of a lot that opens at the first judgement.
fn lot_record(lot: &str) -> LotRecord {
    let recipe_snapshot = "name = \"jzc-22f-012\"\n".to_owned();
    LotRecord {
        lot: lot.to_owned(),
        recipe: "jzc-22f-012".to_owned(),
        recipe_hash: snapshot_hash(&recipe_snapshot),
        recipe_snapshot,
        opened_at_us: BEGIN_US,
        ..LotRecord::default()
    }
}

fn landing(lot: &str, seq: u64) -> LandingRecord {
    LandingRecord {
        lot: lot.to_owned(),
        kind: "lot".to_owned(),
        seq,
        bin: bin(seq).to_owned(),
        at_us: at(seq) + 10,
        cycle_s: Some(1.25),
    }
}

fn bin(seq: u64) -> &'static str {
    if seq.is_multiple_of(10) {
        "voltage"
    } else {
        "pass"
    }
}

fn at(seq: u64) -> i64 {
    BEGIN_US + 1_000_000 * i64::try_from(seq).unwrap()
}

fn part(lot: &str, seq: u64, values: usize) -> PartRecord {
    let fails = seq.is_multiple_of(10);
    let measured = |n: usize| MeasurementRecord {
        key: format!("value_{n}_v"),
        value: Some(7.0 + seq as f64 / 1000.0 + n as f64),
        uncertainty: Some(0.02),
        high: Some(9.0),
        verdict: "pass".to_owned(),
        attempt: 1,
        budget: Some("{\"gain\":0.01}".to_owned()),
        samples: vec![SampleRecord {
            line: "measure".to_owned(),
            module: "01".to_owned(),
            channel: "0".to_owned(),
            command: "#010".to_owned(),
            raw: ">4C53".to_owned(),
            at_us: at(seq) - 1,
        }],
        ..MeasurementRecord::default()
    };
    PartRecord {
        lot: lot.to_owned(),
        seq,
        serial: Some(format!("{lot}-{seq:06}")),
        verdict: if fails { "fail" } else { "pass" }.to_owned(),
        bin: bin(seq).to_owned(),
        reasons: if fails {
            vec![Reason::from_text("operate_voltage_v high")]
        } else {
            vec![]
        },
        judged_at_us: at(seq),
        test_s: 0.61,
        kind: "lot".to_owned(),
        measurements: (0..values).map(measured).collect(),
        ..PartRecord::default()
    }
}
