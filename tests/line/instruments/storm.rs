//! A storm on a link to a simulated instrument: random programs under random faults, and a judge that knows the value of
//! each query.
//!
//! The link runs over an in-process stream in virtual time, with a profile that comes with the program. Each query has a
//! value of its own: the current at a level that no neighbouring query has, or a block of a length of its own. The rules:
//!
//! - a value must be that of its query (else it is *foreign*);
//! - a program must end by its deadline (else it *hangs*);
//! - a failure must have a name and a text in every language (else it is *nameless*).

use bus::instrument::{Link, Opener};
use bus::{Pace, from_streams};
use config::{Folder, load_instrument};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rigsim::scpi::{file, serve};
use scpi::{Echo, Failure, Form, LinkAddress, LinkSettings, Profile, Program, Reply, Step};
use std::collections::BTreeMap;
use std::time::Instant;
use texts::Lang;
use units::RigTime;

/// What is between the link and the instrument, and what the instrument is.
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

/// Most examples of foreign values.
const EXAMPLES: usize = 5;

/// Result of a storm.
#[derive(Debug, Default)]
pub struct Weather {
    /// Queries in programs.
    pub queries: u64,
    /// Values delivered.
    pub delivered: u64,
    /// Failed programs by the name of the failure.
    pub failures: BTreeMap<&'static str, u64>,
    /// Values of another query.
    pub foreign: u64,
    /// Programs that ended after their deadline.
    pub hangs: u64,
    /// Failures without a name or a text.
    pub nameless: u64,
    /// Examples of foreign values.
    pub examples: Vec<String>,
    /// Rig time, seconds.
    pub rig_s: f64,
    /// Wall time, seconds.
    pub wall_s: f64,
}

impl Weather {
    /// Returns true when no rule was broken.
    pub fn is_honest(&self) -> bool {
        self.foreign + self.hangs + self.nameless == 0
    }
}

/// Returns every fault of instruments and links at this probability.
pub fn every_fault(probability: f64) -> Vec<String> {
    let all = rigsim::fault::instrument::list().into_iter();
    let all = all.map(|it| match it.default.split_once('/') {
        Some((_, ms)) => format!("{}={probability}/{ms}", it.name),
        None => format!("{}={probability}", it.name),
    });
    // At the time-out of a query, and ten times later.
    let late = [1_000, 10_000].map(|ms| format!("reply_late={probability}/{ms}"));
    all.chain(late).collect()
}

/// Returns storms of each fault alone at this probability.
pub fn alone(probability: f64) -> impl Iterator<Item = (Way, Vec<String>)> {
    let lost = format!("reply_lost={probability}");
    every_fault(probability).into_iter().map(move |fault| {
        let (way, cause) = match fault.split_once('=').map_or("", |it| it.0) {
            "address_changed" => (Way::Adapter, None),
            name if name.starts_with("block") => (Way::Blocks, None),
            // They strike at a new connection, which needs a cause.
            "half_kept" | "port_busy" | "wrong_identity" => (Way::Network, Some(lost.clone())),
            _ => (Way::Network, None),
        };
        (way, cause.into_iter().chain([fault]).collect())
    })
}

/// Sends at least `queries` queries under `faults`. Needs a current-thread runtime with a paused clock.
pub async fn storm(way: Way, seed: u64, queries: u64, faults: &[String]) -> Weather {
    let (began, pace) = (Instant::now(), Pace::virtual_time());
    let (profile, settings) = settings(way);
    let bench = file::build_text(instruments(way), seed, faults).expect("known faults");
    let (_, plug) = serve::virtual_time(&bench).remove(0);
    let opener = Opener::Streams(from_streams(move || plug.open()));
    let mut link = Link::new(opener, settings, pace, seed);
    let mut random = SplitMix64::seed_from_u64(seed);
    let mut weather = Weather::default();
    while weather.queries < queries {
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
        // The deadline is looked at between the moves, of which each ends within the time of a query.
        let limit = settings.longest(&program) + settings.limit + settings.limit;
        let began = pace.now();
        let outcome = tokio::select! {
            outcome = link.run(program) => Some(outcome),
            () = pace.sleep_until(began + limit) => None,
        };
        match outcome {
            None => weather.hangs += 1,
            Some(Ok(replies)) => weather.judge(&values, &replies, pace.now().since(began).0),
            Some(Err(failure)) => weather.note(&failure),
        }
    }
    weather.rig_s = pace.now().since(RigTime(0)).as_seconds();
    weather.wall_s = began.elapsed().as_secs_f64();
    weather
}

impl Weather {
    fn judge(&mut self, values: &[Value], replies: &[Reply], taken_us: u64) {
        let expected: Vec<_> = values.iter().flat_map(|it| it.expected()).collect();
        self.delivered += values.len() as u64;
        let own = |(found, expected): (&Reply, &Expected)| expected.is(found);
        if replies.len() != expected.len() || !replies.iter().zip(&expected).all(own) {
            self.foreign += 1;
            let found = format!("{expected:?} after {taken_us} us: {replies:?}");
            self.examples
                .extend((self.examples.len() < EXAMPLES).then_some(found));
        }
    }

    fn note(&mut self, failure: &Failure) {
        *self.failures.entry(failure.code()).or_default() += 1;
        let message = app::instrument::message(failure);
        let named = Lang::ALL
            .iter()
            .all(|lang| message.try_say(*lang).is_some());
        self.nameless += u64::from(!named);
    }
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
    Bytes(u64),
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
                Expected::Bytes(self.points()),
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
            (Self::Bytes(bytes), Reply::Block(found)) => found.len() as u64 == *bytes,
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
