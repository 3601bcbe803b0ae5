//! The interface board: coil supply, contact source, monitors, references and interlocks.
//!
//! Coil drive and contact source need the closed probe-up chain. The source waits until the selected contact has been
//! closed for a while. It switches off before any change of drive, selection or direction, which therefore takes effect
//! later. The coil suppression changes only without coil current. Every measuring terminal follows its circuit, with or
//! without a part.

mod circuit;
pub mod supply;

use super::draw::Draw;
use super::gates::Gates;
use super::probes::{Contact, Supply};
use super::signal::{Commands, In, Out, Source};
use super::specimen::Specimen;
use super::table::BoardTable;
use crate::config::References;
use crate::truth::Overdrive;
use supply::{CoilSupply, SupplyRange};

/// Greatest resistance between force and sense probe at which a pin counts as connected, ohm.
const KELVIN_OHM: f64 = 5.0;

/// Present state of drive, selection and direction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Switches {
    drive: bool,
    select_no: bool,
    reverse: bool,
}

/// The interface board.
#[derive(Debug, Clone)]
pub struct Board {
    table: BoardTable,
    gates: Gates,
    source_a: f64,
    reference_coil_ohm: f64,
    reference_contact_ohm: f64,
    reference_v: f64,
    pulse_us: f64,
    supply: CoilSupply,
    divider: f64,
    commands: Commands,
    switches: Switches,
    switch_at_us: Option<f64>,
    driving: bool,
    clamp_diode: bool,
    chain: bool,
    touching: bool,
    /// Resistance of the film on both coil probes together, ohm; the next field is its growth per touch.
    film_ohm: f64,
    film_per_touch_ohm: f64,
    source_live: bool,
    closed_since_us: Option<f64>,
    now_us: f64,
}

impl Board {
    /// Creates a board; draws its errors.
    pub fn new(
        table: &BoardTable,
        reference: &References,
        supply: CoilSupply,
        draw: &mut Draw,
    ) -> Self {
        let mut within = |value: f64, pct: f64| value * (1.0 + draw.half(pct / 100.0));
        let source_a = within(table.source_current_a, table.source_error_pct);
        let reference_coil_ohm = within(reference.coil_ohm, reference.coil_tolerance_pct);
        let contact = within(reference.contact_mohm, reference.contact_tolerance_pct);
        let reference_v = within(reference.voltage_v, reference.voltage_tolerance_pct);
        let delay = [
            draw.half(table.gate_delay_us),
            draw.half(table.gate_delay_us),
        ];
        Self {
            table: table.clone(),
            gates: Gates::new(delay, table.window_after_latch_ms * 1000.0),
            source_a,
            reference_coil_ohm,
            reference_contact_ohm: contact * 1e-3,
            reference_v,
            pulse_us: reference.gate_pulse_ms * 1000.0,
            supply,
            divider: 1.0,
            commands: Commands::default(),
            switches: Switches::default(),
            switch_at_us: None,
            driving: false,
            clamp_diode: false,
            chain: false,
            touching: false,
            film_ohm: 0.0,
            film_per_touch_ohm: 0.0,
            source_live: false,
            closed_since_us: None,
            now_us: 0.0,
        }
    }

    /// Advances board and part to `t_us`.
    pub fn advance(&mut self, t_us: f64, mut part: Option<&mut Specimen>) {
        loop {
            let due = self.next_us().filter(|&at| at <= t_us);
            let until = due.unwrap_or(t_us);
            if let Some(part) = part.as_deref_mut()
                && let Some(change) = part.advance(until)
            {
                self.now_us = change.t_us;
                self.contact_event(change.contact, change.closed, part);
                self.refresh(Some(part));
                continue;
            }
            self.now_us = until;
            if due.is_none() {
                return;
            }
            self.expire(part.as_deref_mut());
        }
    }

    /// Sets the terminal of a source of the coil supply to `volts`.
    pub fn supply(&mut self, source: Source, volts: f64, part: Option<&mut Specimen>) {
        if self.supply.set(source, volts) && self.commands.is_on(Out::RampMode) {
            self.gates.start(self.now_us);
        }
        self.refresh(part);
    }

    /// Applies all commands of the controller.
    pub fn command(&mut self, commands: Commands, mut part: Option<&mut Specimen>) {
        let before = std::mem::replace(&mut self.commands, commands);
        self.refresh(part.as_deref_mut());
        if commands.rises(before, Out::Arm) {
            self.supply.arm();
            let pulse = commands
                .is_on(Out::ReferenceContact)
                .then_some(self.pulse_us);
            self.gates.arm(self.now_us, pulse);
        }
        if self.commanded() == self.switches || self.switch_at_us.is_some() {
            return;
        }
        if self.source_live {
            self.source_live = false;
            self.switch_at_us = Some(self.now_us + self.table.source_lead_ms * 1000.0);
        } else {
            self.set_switches(part);
        }
    }

    /// Sets the state of the probes: block up (`chain`), and in contact with a part (`touching`).
    pub fn probe(&mut self, chain: bool, touching: bool, part: Option<&mut Specimen>) {
        if touching && !self.touching {
            self.film_ohm += self.film_per_touch_ohm;
        }
        self.chain = chain;
        self.touching = touching;
        self.refresh(part);
    }

    /// Lets each further touch of the probes add this film to both coil probes together, ohm.
    pub fn add_film_per_touch(&mut self, per_touch_ohm: f64) {
        self.film_per_touch_ohm = per_touch_ohm;
    }

    /// Shifts the ratio of the coil voltage divider by `per_mille` parts per thousand.
    pub fn drift(&mut self, per_mille: f64) {
        self.divider = 1.0 + per_mille * 1e-3;
    }

    /// Makes the range relays of the supply stick in a range.
    pub fn stick(&mut self, range: SupplyRange) {
        self.supply.stick(range);
    }

    /// Returns every overdrive of a coil so far, in order of time.
    pub fn overdrives(&self) -> &[Overdrive] {
        self.supply.overdrives()
    }

    /// Returns the total open time of a gate so far, microseconds.
    pub fn gate_open_us(&self, gate: usize) -> f64 {
        self.gates.open_us(gate, self.now_us)
    }

    /// Returns a digital signal of the board; `None` for a signal that the board does not drive.
    pub fn signal(&self, signal: In, part: Option<&Specimen>) -> Option<bool> {
        let kelvin = |pin: usize| {
            let film_ohm = if pin < 2 { self.film_ohm / 2.0 } else { 0.0 };
            let clean = film_ohm < KELVIN_OHM;
            let good = clean && part.is_some_and(|it| it.pins().kelvin[pin]);
            Some(self.commands.is_on(Out::KelvinTest) && self.touching && good)
        };
        match signal {
            In::KelvinCoilA => kelvin(0),
            In::KelvinCoilB => kelvin(1),
            In::KelvinCom => kelvin(2),
            In::KelvinNo => kelvin(3),
            In::KelvinNc => kelvin(4),
            In::NoClosed => Some(self.senses(Contact::No, part)),
            In::NcClosed => Some(self.senses(Contact::Nc, part)),
            In::Window => Some(self.gates.window()),
            In::Latch => Some(self.gates.latch()),
            In::SourceCompliance => Some(self.source_limited(part)),
            In::ProbeChain => Some(self.chain),
            In::SupplyRange0Set => Some(self.supply.range().code & 1 != 0),
            In::SupplyRange1Set => Some(self.supply.range().code & 2 != 0),
            _ => None,
        }
    }

    fn commanded(&self) -> Switches {
        Switches {
            drive: self.commands.is_on(Out::CoilDrive),
            select_no: self.commands.is_on(Out::SelectNo),
            reverse: self.commands.is_on(Out::SourceReverse),
        }
    }

    fn selected(&self) -> Contact {
        if self.switches.select_no {
            Contact::No
        } else {
            Contact::Nc
        }
    }

    fn selected_closed(&self, part: Option<&Specimen>) -> bool {
        self.commands.is_on(Out::ReferenceContact) || self.senses(self.selected(), part)
    }

    /// Returns the instant of the next event that the board causes by itself, microseconds; `None` without one.
    fn next_us(&self) -> Option<f64> {
        let times = [
            self.switch_at_us,
            self.source_due_us(),
            self.supply.next_us(),
            self.gates.next_us(),
        ];
        times.into_iter().flatten().min_by(f64::total_cmp)
    }

    fn source_due_us(&self) -> Option<f64> {
        let wanted = self.commands.is_on(Out::SourceOn) && self.chain && !self.source_live;
        let since = self
            .closed_since_us
            .filter(|_| wanted && self.switch_at_us.is_none())?;
        Some((since + self.table.source_wait_ms * 1000.0).max(self.now_us))
    }

    fn expire(&mut self, part: Option<&mut Specimen>) {
        let now = self.now_us;
        self.gates.expire(now);
        if self.switch_at_us.is_some_and(|at| at <= now) {
            self.switch_at_us = None;
            self.set_switches(part);
        } else if self.supply.expire(now) {
            self.refresh(part);
        } else if self.source_due_us().is_some_and(|at| at <= now) {
            self.source_live = true;
            self.refresh(part);
        }
    }

    /// Switches drive, selection and direction to the commanded state.
    fn set_switches(&mut self, part: Option<&mut Specimen>) {
        let before = self.switches;
        self.switches = self.commanded();
        if before.select_no != self.switches.select_no {
            self.closed_since_us = None;
        }
        self.refresh(part);
    }

    /// Passes a contact event that the monitor detects to the latch, if it is the selected one.
    fn contact_event(&mut self, contact: Contact, closed: bool, part: &Specimen) {
        let met = part.pins().contact(contact) && self.touching;
        if !met || self.commands.is_on(Out::ReferenceContact) {
            return;
        }
        let chosen = match self.commands.is_on(Out::EventNoBreak) {
            true => contact == Contact::No && !closed,
            false => contact == self.selected() && closed && self.detects_closed(part, contact),
        };
        if chosen {
            self.gates.event(self.now_us);
        }
    }

    /// Updates everything that follows without delay from commands, probes and contacts.
    fn refresh(&mut self, mut part: Option<&mut Specimen>) {
        let now = self.now_us;
        self.select_clamp(part.as_deref());
        self.edges_of_drive();
        let drive_off = !self.switches.drive && !self.commands.is_on(Out::CoilDrive);
        self.supply.follow(now, self.commands, drive_off);
        let on_coil = part.as_deref().is_some_and(|it| self.drives(it));
        self.supply.watch(now, self.commands, on_coil);
        if let Some(part) = part.as_deref_mut() {
            let supply = self.coil_supply(part);
            part.drive(now, supply);
        }
        let closed = self.selected_closed(part.as_deref());
        match (closed, self.closed_since_us) {
            (true, None) => self.closed_since_us = Some(now),
            (false, Some(_)) => self.closed_since_us = None,
            (true, Some(_)) | (false, None) => {}
        }
        self.source_live &= closed && self.chain && self.commands.is_on(Out::SourceOn);
        self.gates.contact(now, closed);
        if let Some(part) = part
            && self.source_live
            && !self.commands.is_on(Out::ReferenceContact)
        {
            part.source_on(self.selected());
        }
    }

    fn select_clamp(&mut self, part: Option<&Specimen>) {
        let wanted = self.commands.is_on(Out::ClampDiode);
        let free = self.coil_a(part).abs() * 1000.0 < self.table.clamp_select_below_ma;
        if wanted != self.clamp_diode && free {
            self.clamp_diode = wanted;
        }
    }

    /// Passes an edge of the drive to the window flip-flop: the edge that starts a measurement, or the opposite one.
    fn edges_of_drive(&mut self) {
        let driving = self.switches.drive && self.chain;
        if driving == std::mem::replace(&mut self.driving, driving) {
            return;
        }
        let (ramp, no) = (self.commands.is_on(Out::RampMode), self.switches.select_no);
        match (ramp, driving == no) {
            (false, true) => self.gates.start(self.now_us),
            (false, false) => self.gates.opposite(self.now_us),
            (true, _) if !driving => self.gates.opposite(self.now_us),
            (true, _) => {}
        }
    }

    /// Checks whether the drive reaches the coil of the part.
    fn drives(&self, part: &Specimen) -> bool {
        self.driving && self.meets(part) && !self.commands.is_on(Out::ReferenceCoil)
    }

    /// Checks whether both coil probes touch the coil pins of the part.
    fn meets(&self, part: &Specimen) -> bool {
        self.touching && part.pins().input()
    }

    fn coil_supply(&self, part: &Specimen) -> Supply {
        if self.drives(part) {
            return Supply::Volts(self.coil_input_v(part.input_ohm()));
        }
        let suppression_v = if self.clamp_diode && self.meets(part) {
            self.table.diode_v
        } else {
            self.zener_v()
        };
        Supply::Off { suppression_v }
    }
}
