//! A storm on a link to a simulated instrument: random programs under random faults, and a judge that knows the value
//! of each query.
//!
//! The link runs over an in-process stream in virtual time, with a profile that comes with the program. Each query has
//! a value of its own: the current at a level that no neighbouring query has, or a block of a length of its own. The
//! rules:
//!
//! - a value must be that of its query (else it is *foreign*);
//! - a program must end by its deadline (else it *hangs*);
//! - a failure must have a name and a text in every language (else it is *nameless*);
//! - after the last fault at most two programs fail (else the link has not *recovered*): the first meets what the
//!   faults left behind, such as a late reply or the local mode; the second may find, as it resynchronises, that the
//!   instrument was switched off.

use bus::instrument::{Link, Opener};
use bus::{Pace, from_streams};
use config::{Folder, load_instrument};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rigsim::scpi::{file, serve};
use scpi::{Echo, Failure, Form, LinkAddress, LinkSettings, Profile, Program, Reply, Step};
use std::time::Instant;
use texts::Lang;
use units::RigTime;

/// Path from the link to the instrument, and kind of instrument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    Network,
    Serial,
    Adapter,
    /// An instrument without `*ESE` on the network.
    Identity,
    /// A digitizer on the network, whose replies are blocks.
    Blocks,
}

pub const WAYS: [Way; 5] = [
    Way::Network,
    Way::Serial,
    Way::Adapter,
    Way::Identity,
    Way::Blocks,
];

/// Largest number of examples of broken rules.
const EXAMPLES: usize = 5;
/// Number of programs after the last fault.
const CALM: u64 = 20;
/// Number of programs after the last fault that may fail.
const RECOVERY: u64 = 2;

/// Result of a storm.
#[derive(Debug, Default)]
pub struct Weather {
    /// Queries in programs.
    pub queries: u64,
    /// Values delivered.
    pub delivered: u64,
    /// Names of the failures, in order.
    pub failures: Vec<&'static str>,
    /// Values of another query.
    pub foreign: u64,
    /// Programs that ended after their deadline.
    pub hangs: u64,
    /// Failures without a name or a text.
    pub nameless: u64,
    /// Programs that failed long after the last fault.
    pub unrecovered: u64,
    /// Examples of broken rules.
    pub examples: Vec<String>,
    /// Rig time, seconds.
    pub rig_s: f64,
    /// Wall time, seconds.
    pub wall_s: f64,
}

impl Weather {
    /// Returns true when no rule was broken.
    pub fn is_honest(&self) -> bool {
        self.foreign + self.hangs + self.nameless + self.unrecovered == 0
    }

    fn judge(&mut self, values: &[Value], replies: &[Reply], taken_us: u64) {
        let expected: Vec<_> = values.iter().flat_map(|it| it.expected()).collect();
        self.delivered += values.len() as u64;
        let own = |(found, expected): (&Reply, &Expected)| expected.is(found);
        if replies.len() != expected.len() || !replies.iter().zip(&expected).all(own) {
            self.foreign += 1;
            self.example(format!("{expected:?} after {taken_us} us: {replies:?}"));
        }
    }

    /// Notes a failed program, the one with the number `calm` after the last fault.
    fn note(&mut self, failure: &Failure, calm: u64) {
        self.failures.push(failure.code());
        let message = app::instrument::message(failure);
        let named = Lang::ALL
            .iter()
            .all(|lang| message.try_say(*lang).is_some());
        self.nameless += u64::from(!named);
        if calm > RECOVERY {
            self.unrecovered += 1;
            self.example(format!("program {calm} after the last fault: {failure}"));
        }
    }

    fn example(&mut self, text: String) {
        if self.examples.len() < EXAMPLES {
            self.examples.push(text);
        }
    }
}

/// Returns every fault of instruments and links at this probability, until an instant of rig time.
pub fn every_fault(probability: f64, until_s: f64) -> Vec<String> {
    let all = rigsim::fault::instrument::list().into_iter();
    let all = all.map(|it| match it.default.split_once('/') {
        Some((_, ms)) => format!("{}={probability}/{ms}", it.name),
        None => format!("{}={probability}", it.name),
    });
    // At the time-out of a query, and ten times later.
    let late = [1_000, 10_000].map(|ms| format!("reply_late={probability}/{ms}"));
    let all = all.chain(late);
    all.map(|it| format!("{it}@0..{until_s}")).collect()
}

/// Faults that strike only after a connection has ended.
const AFTER_AN_END: [&str; 3] = ["half_kept", "port_busy", "wrong_identity"];

/// Returns each fault alone at this probability until an instant of rig time, with the way on which it strikes; a fault
/// that needs the end of a connection comes with one.
pub fn each_fault(probability: f64, until_s: f64) -> Vec<(Way, Vec<String>)> {
    let alone = every_fault(probability, until_s).into_iter();
    let with_way = |fault: String| {
        let name = fault.split('=').next().unwrap_or_default();
        let way = match name {
            _ if name.starts_with("block_") => Way::Blocks,
            "address_changed" => Way::Adapter,
            _ => Way::Network,
        };
        let ends = AFTER_AN_END.contains(&name);
        let end = ends.then(|| format!("closed_before={probability}@0..{until_s}"));
        (way, std::iter::once(fault).chain(end).collect())
    };
    alone.map(with_way).collect()
}

/// Sends programs under `faults`, which end at `until_s` of rig time, and [`CALM`] programs after that. Needs a
/// runtime of virtual time.
pub async fn storm(way: Way, seed: u64, faults: &[String], until_s: f64) -> Weather {
    let (wall, pace) = (Instant::now(), Pace::virtual_time());
    let (profile, settings) = settings(way);
    let bench = file::build_text(instruments(way), seed, faults).expect("known faults");
    let (_, plug) = serve::virtual_time(&bench).remove(0);
    let opener = Opener::Streams(from_streams(move || plug.open()));
    let mut link = Link::new(opener, settings, pace, seed);
    let mut random = SplitMix64::seed_from_u64(seed);
    let mut weather = Weather::default();
    let mut calm = 0;
    while calm < CALM {
        let first = weather.queries;
        let values: Vec<Value> = (first..=first + random.next_u64() % 4)
            .map(|number| Value { way, number })
            .collect();
        weather.queries += values.len() as u64;
        let steps = values.iter().flat_map(|it| it.program(&profile).steps);
        let program = Program {
            steps: steps.collect(),
        };
        let settings = link.session().settings();
        // The link checks the deadline between its steps; each step ends within the time of a query.
        let limit = settings.longest(&program) + settings.limit + settings.limit;
        let began = pace.now();
        calm += u64::from(began.since(RigTime(0)).as_seconds() >= until_s);
        let outcome = tokio::select! {
            outcome = link.run(program) => Some(outcome),
            () = pace.sleep_until(began + limit) => None,
        };
        match outcome {
            None => weather.hangs += 1,
            Some(Ok(replies)) => weather.judge(&values, &replies, pace.now().since(began).0),
            Some(Err(failure)) => weather.note(&failure, calm),
        }
    }
    weather.rig_s = pace.now().since(RigTime(0)).as_seconds();
    weather.wall_s = wall.elapsed().as_secs_f64();
    weather
}

/// The value that a query asks for.
struct Value {
    way: Way,
    number: u64,
}

/// What a reply must be.
#[derive(Debug)]
enum Expected {
    Amps(f64),
    /// Preamble of a waveform with this number of points.
    Points(u64),
    /// Block with this number of 16-bit samples.
    Samples(u64),
}

impl Value {
    /// Returns a level that differs from that of the 10,000 queries before.
    fn level_v(&self) -> f64 {
        1.0 + (self.number % 10_000) as f64 * 1e-3
    }

    fn points(&self) -> u64 {
        1 + self.number % 200
    }

    fn program(&self, profile: &Profile) -> Program {
        let program = match self.way {
            Way::Blocks => profile.program(
                "waveform",
                &[("channel", 1.0), ("points", self.points() as f64)],
            ),
            _ => profile.program("current_at_level", &[("level_v", self.level_v())]),
        };
        program.expect("a program of the profile")
    }

    fn expected(&self) -> Vec<Expected> {
        match self.way {
            Way::Blocks => vec![
                Expected::Points(self.points()),
                Expected::Samples(self.points()),
            ],
            _ => vec![Expected::Amps(self.level_v() / 1e3)],
        }
    }
}

impl Expected {
    fn is(&self, found: &Reply) -> bool {
        match (self, found) {
            (Self::Amps(amps), Reply::Number(found)) => (amps - found).abs() < 1e-9,
            (Self::Points(points), Reply::Numbers(found)) => {
                found.get(2) == Some(&(*points as f64))
            }
            (Self::Samples(samples), Reply::Block(found)) => found.len() as u64 == 2 * samples,
            _ => false,
        }
    }
}

/// Returns the file of instruments: one without errors, over 1 kohm.
fn instruments(way: Way) -> &'static str {
    match way {
        Way::Network | Way::Identity => {
            "[[instrument]]\nname = 'smu'\nmodel = '2450'\nexact = true\ntcp = 0"
        }
        Way::Serial => "[[instrument]]\nname = 'smu'\nmodel = '2450'\nexact = true\nbaud = 115200",
        Way::Adapter => {
            "[[adapter]]\nname = 'gpib'\ntcp = 0\n
            [[instrument]]\nname = 'smu'\nmodel = '2450'\nexact = true\nadapter = 'gpib'\ngpib = 9"
        }
        Way::Blocks => {
            "[[instrument]]\nname = 'scope'\nmodel = 'digitizer-rigol'\nexact = true\ntcp = 0"
        }
    }
}

fn settings(way: Way) -> (Profile, LinkSettings) {
    let (name, address) = match way {
        Way::Network | Way::Identity => ("smu-2450", "tcp:host:5025"),
        Way::Serial => ("smu-2450", "serial:/dev/tty:115200"),
        Way::Adapter => ("smu-2450", "gpib-tcp:host:1234:9"),
        Way::Blocks => ("digitizer-rigol", "tcp:host:5555"),
    };
    let profile = load_instrument(&Folder::built_in(), name).expect("a profile of the program");
    let address: LinkAddress = address.parse().expect("an address");
    let mut settings = profile.link_settings(&address);
    settings.remote = Some("SYST:REM".to_owned());
    match way {
        Way::Identity => settings.echo = Echo::Identity,
        Way::Blocks => settings.set_up.steps.extend([
            Step::send(":ACQ:MDEP 200"),
            Step::send(":TRIG:SWE AUTO"),
            Step::send(":RUN"),
            Step::ask("*OPC?", Form::Number),
        ]),
        Way::Network | Way::Serial | Way::Adapter => {}
    }
    (profile, settings)
}
