//! Writes the account of a story, line by line.
//!
//! Counts whole seconds from the first action of the script or the first alarm; lines about the ordinary course of a
//! lot carry no time. The first alarm of each code comes with its cause, consequence and action.

use super::play::Refusal;
use super::script::{Awaited, Script, Step};
use cycle::{Event, PANEL};
use machine::dut::Verdict;
use machine::handling::ledger::{Part, PartRole};
use machine::handling::output::{Judged, Landed};
use machine::rig::bin::Bin;
use machine::station::annunciator::ListedAlarm;
use machine::station::catalogue::AlarmCode;
use machine::station::trouble::Alarm;
use rigsim::{SharedRig, SimError};
use std::collections::{BTreeMap, BTreeSet};
use texts::{Lang, Message};
use units::RigTime;

/// What the account of a story says about one part.
#[derive(Debug)]
struct Told {
    name: String,
    verdict: &'static str,
    /// Why a complete test could not judge the part, after a colon; empty for other parts.
    why: String,
}

impl Told {
    fn of(judged: &Judged) -> Self {
        let why = match (&judged.verdict, &judged.part.interrupted) {
            (Verdict::Void(_), None) => format!(": {}", judged.verdict.texts().join(", ")),
            (Verdict::Void(_), Some(_)) | (Verdict::Pass | Verdict::Fail(_), _) => String::new(),
        };
        Self {
            name: name(&judged.part),
            verdict: judged.verdict.name(),
            why,
        }
    }
}

/// Account of a story.
#[derive(Debug)]
pub struct Narrator {
    text: String,
    /// Rig time of the first action of the script or the first alarm, from which the account counts seconds; `None`
    /// before both.
    zero: Option<RigTime>,
    /// Each judged part, by ordinal.
    parts: BTreeMap<u64, Told>,
    explained: BTreeSet<AlarmCode>,
    /// Alarms whose cause is present.
    active: Vec<Alarm>,
    bins: BTreeMap<Bin, u64>,
}

impl Narrator {
    /// Begins the account with the title of the script.
    pub fn new(script: &Script) -> Self {
        let faults: String = script
            .faults
            .iter()
            .map(|fault| format!(", fault {fault}"))
            .collect();
        Self {
            text: format!("{}\nlot of {}{faults}\n\n", script.title, script.parts),
            zero: None,
            parts: BTreeMap::new(),
            explained: BTreeSet::new(),
            active: Vec::new(),
            bins: BTreeMap::new(),
        }
    }

    /// Adds a line about an event of the cycle at `now`.
    pub fn event(&mut self, event: &Event, now: RigTime) {
        match event {
            Event::LotBegan(_) => self.plain("the lot begins"),
            Event::State(state) if self.zero.is_some() => {
                self.stamped(now, &format!("machine   {}", state.name()));
            }
            Event::Alarm(alarm, _) => self.alarm(alarm, now),
            Event::Judged(judged) => {
                let told = Told::of(judged);
                if let Some(why) = &judged.part.interrupted {
                    let name = &told.name;
                    self.stamped(now, &format!("{name:<9} not judged, to retest: {why}"));
                }
                self.parts.insert(judged.part.ordinal, told);
            }
            Event::Interrupted(interrupted) => {
                if let Some(told) = self.parts.get_mut(&interrupted.ordinal) {
                    let was = std::mem::replace(&mut told.verdict, "void");
                    let (name, why) = (told.name.clone(), &interrupted.why);
                    self.stamped(
                        now,
                        &format!("{name:<9} {was}, to retest all the same: {why}"),
                    );
                }
            }
            Event::Landed(landed) => self.landed(landed),
            Event::ListedAlarms(standing, _) => self.standing(standing, now),
            Event::Ordered(answered, _) if answered.by.origin == PANEL => {
                let refused = answered.refused.as_ref();
                let said = |why: &Message| format!(": refused, {}", why.say(Lang::En));
                let why = refused.map_or_else(String::new, said);
                self.stamped(now, &format!("panel     {}{why}", answered.order.word()));
            }
            Event::State(_)
            | Event::Left(_)
            | Event::Checked(..)
            | Event::Ordered(..)
            | Event::Inside(..)
            | Event::Calibrated(_)
            | Event::BatchEnded(_)
            | Event::Found(_)
            | Event::Prompted(_)
            | Event::PromiseBroken(_) => {}
        }
    }

    /// Adds a line about a fault that the script applied, or that the simulated rig refused.
    pub fn fault(&mut self, fault: &str, injected: Result<(), SimError>, now: RigTime) {
        let text = match injected {
            Ok(()) => format!("rig       {fault}"),
            Err(why) => format!("rig       {fault}: {why}"),
        };
        self.begin(now);
        self.stamped(now, &text);
    }

    /// Adds a line about an order of the script, with its answer.
    pub fn order(&mut self, words: &str, answer: Result<Option<Message>, Refusal>, now: RigTime) {
        let text = match answer {
            Ok(None) => format!("operator  {words}"),
            Ok(Some(remark)) => format!("operator  {words}: {}", remark.say(Lang::En)),
            Err(why) => format!("operator  {words}: refused, {why}"),
        };
        self.begin(now);
        self.stamped(now, &text);
    }

    /// Adds a line that says that no event came in time, and which event the script still awaits.
    pub fn silence(&mut self, awaited: Option<&Step>, now: RigTime) {
        let text = match awaited.map(|step| &step.event) {
            Some(event) => format!(
                "nothing happens any more; the script waits for {}",
                words(event)
            ),
            None => "nothing happens any more".to_owned(),
        };
        self.stamped(now, &text);
    }

    /// Returns the account, which ends with the parts in each bin, the collisions and the overdriven coils of `rig`.
    pub fn end(mut self, rig: &SharedRig) -> String {
        let bins: Vec<String> = self
            .bins
            .iter()
            .map(|(bin, n)| format!("{bin} {n}"))
            .collect();
        self.text += &format!("\nin the bins: {}\n", bins.join(", "));
        for crash in rig.crashes() {
            self.text += &format!("BODIES TOUCHED: {crash}\n");
        }
        for overdrive in rig.overdrives() {
            self.text += &format!("COIL OVERDRIVEN: {overdrive}\n");
        }
        if !rigsim::world::bodies::WATCHED {
            self.text += "bodies: not watched\n";
        }
        self.text
    }

    fn begin(&mut self, now: RigTime) {
        self.zero.get_or_insert(now);
    }

    fn alarm(&mut self, alarm: &Alarm, now: RigTime) {
        self.begin(now);
        self.stamped(
            now,
            &format!("ALARM     {}: {}", alarm.code, alarm.text(Lang::En)),
        );
        if self.explained.insert(alarm.code) {
            let help = alarm.code.help(Lang::En);
            for (word, text) in ["cause", "follows", "to do"].into_iter().zip(help) {
                self.plain(&format!("          {word:<8} {text}"));
            }
        }
    }

    fn standing(&mut self, standing: &[ListedAlarm], now: RigTime) {
        let active = standing.iter().filter(|one| one.is_active());
        let active: Vec<Alarm> = active.map(|one| one.alarm.clone()).collect();
        for gone in std::mem::replace(&mut self.active, active.clone()) {
            if !active.iter().any(|it| it.is_same(&gone)) {
                self.stamped(now, &format!("gone      {}", gone.code));
            }
        }
    }

    fn landed(&mut self, landed: &Landed) {
        let (part, bin) = (&landed.part, landed.bin);
        if let (PartRole::Lot(_), Some(told)) = (&part.role, self.parts.get(&part.ordinal)) {
            let Told { name, verdict, why } = told;
            let text = format!("{name:<9} {verdict}, in bin {bin}{why}");
            *self.bins.entry(bin).or_insert(0) += 1;
            self.plain(&text);
        }
    }

    fn plain(&mut self, text: &str) {
        self.text += &format!("        {text}\n");
    }

    fn stamped(&mut self, now: RigTime, text: &str) {
        match self.zero {
            Some(zero) => {
                let seconds = now.since(zero).0 / 1_000_000;
                self.text += &format!("{seconds:>4} s  {text}\n");
            }
            None => self.plain(text),
        }
    }
}

fn name(part: &Part) -> String {
    match &part.role {
        PartRole::Reference(serial) => format!("part {serial}"),
        PartRole::Lot(number) => format!("part {number}"),
    }
}

fn words(event: &Awaited) -> String {
    match event {
        Awaited::Lot => "the lot".to_owned(),
        Awaited::State(state) => format!("state {}", state.name()),
        Awaited::Alarm(code) => format!("alarm {code}"),
        Awaited::Judged(part) => format!("part {part} to be judged"),
        Awaited::Left(part) => format!("part {part} to leave the nest"),
        Awaited::Landed(part) => format!("part {part} to land"),
    }
}
