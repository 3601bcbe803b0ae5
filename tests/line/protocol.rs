//! The protocol on both sides, command by command. Controller and simulated modules implement the same manuals
//! independently.

use bus::{Answer, Failure, LineError, LineSettings, Pace, Request};
use dcon::{
    Address, AnalogIn, BaudCode, Command, Common, Config, Counter, FormatByte, Model, ModuleName,
    Reply, ReplyError, TypeCode, UpTo, decode_request, factory_command,
};
use rigsim::{SharedRig, bench, wire};
use std::collections::BTreeSet;
use texts::{Lang, Message};
use tokio::sync::mpsc;

const TABLE: &str = include_str!("protocol.txt");

/// Families of commands, each with the text of the file that declares it.
const FAMILIES: [(&str, &str); 5] = [
    (
        "Common",
        include_str!("../../crates/dcon/src/every_module.rs"),
    ),
    (
        "AnalogIn",
        include_str!("../../crates/dcon/src/analog_in.rs"),
    ),
    (
        "AnalogOut",
        include_str!("../../crates/dcon/src/analog_out.rs"),
    ),
    ("Digital", include_str!("../../crates/dcon/src/digital.rs")),
    ("Counter", include_str!("../../crates/dcon/src/counter.rs")),
];

/// Mark of a command that no rig may send, instead of a model.
const NEVER: &str = "never";

/// Returns request and models of every row.
fn table() -> impl Iterator<Item = (&'static str, Vec<&'static str>)> {
    let rows = TABLE
        .lines()
        .filter(|row| !row.starts_with("# ") && !row.is_empty());
    rows.map(|row| {
        let mut words = row.split_whitespace();
        (words.next().unwrap(), words.collect())
    })
}

fn models() -> BTreeSet<&'static str> {
    let all = table().flat_map(|(_, models)| models);
    all.filter(|model| *model != NEVER).collect()
}

/// Returns the commands of this model that `request` can mean.
fn meant(model: &str, request: &str) -> Vec<Command> {
    let model = Model::of_name(model).unwrap();
    let mut meant = decode_request(request.as_bytes());
    meant.retain(|command| model.has_command(command));
    meant
}

#[test]
fn every_module_answers_every_command() {
    let mut broken = Vec::new();
    for model in models() {
        // With INIT* grounded the modules of series M-7000 accept every command.
        let init = model.starts_with("M-");
        let text =
            format!("baud = 9600\n[[module]]\naddress = 1\nmodel = \"{model}\"\ninit = {init}");
        let mut rig = bench::build_text(&text).unwrap();
        for (at_us, (request, models)) in (0..).zip(table()) {
            if !models.contains(&model) {
                continue;
            }
            let meant = meant(model, request);
            let reply = rig.exchange(0, request.as_bytes(), at_us);
            let read = |reply: &[u8]| meant.iter().any(|it| it.decode(reply, false).is_ok());
            let whole = match &reply {
                Some(reply) => read(&reply.bytes),
                None => matches!(meant[..], [Command::HostOk | Command::SampleAll]),
            };
            if !whole {
                broken.push(format!("{model} {request}: {reply:?} to {meant:?}"));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn the_table_holds_every_command_that_can_be_written() {
    let mut named = BTreeSet::new();
    for command in table().flat_map(|(request, _)| decode_request(request.as_bytes())) {
        let (family, ask) = match command {
            Command::HostOk | Command::SampleAll => continue,
            Command::Common(_, ask) => ("Common", format!("{ask:?}")),
            Command::AnalogIn(_, ask) => ("AnalogIn", format!("{ask:?}")),
            Command::AnalogOut(_, ask) => ("AnalogOut", format!("{ask:?}")),
            Command::Digital(_, ask) => ("Digital", format!("{ask:?}")),
            Command::Counter(_, ask) => ("Counter", format!("{ask:?}")),
        };
        let name = ask.split(|letter: char| !letter.is_alphanumeric()).next();
        named.insert(format!("{family} {}", name.unwrap()));
    }
    for (family, source) in FAMILIES {
        let (_, body) = source
            .split_once(&format!("pub enum {family} {{\n"))
            .unwrap();
        let body = body.split("\n}\n").next().unwrap();
        let names = body.lines().filter_map(|line| line.strip_prefix("    "));
        let names = names.filter(|line| line.starts_with(char::is_uppercase));
        let names = names.filter_map(|line| line.split(|c: char| !c.is_alphanumeric()).next());
        let mut count = 0;
        for name in names {
            count += 1;
            let known = named.contains(&format!("{family} {name}"));
            assert!(known, "{family}::{name} has no row in protocol.txt");
        }
        assert!(count > 8, "{family}: only {count} commands found");
    }
}

#[test]
fn the_document_lists_every_request() {
    let document = include_str!("../../docs/bus.md");
    let mut count = 0;
    for line in FAMILIES.iter().flat_map(|(_, source)| source.lines()) {
        let comment = line.trim_start().strip_prefix("/// `");
        let quoted = comment.into_iter().flat_map(|it| it.split('`').step_by(2));
        for request in quoted.filter(|it| it.starts_with(['#', '$', '%', '@', '~'])) {
            count += 1;
            assert!(document.contains(&format!("`{request}`")), "{request}");
        }
    }
    assert!(count > 60, "only {count} requests found");
}

#[test]
fn every_request_and_reply_has_words_in_both_languages() {
    let mut broken = BTreeSet::new();
    let mut check = |message: Message| {
        for lang in Lang::ALL {
            let wanted = texts::arguments(lang, &message.id(), None);
            if !wanted.is_some_and(|it| it.into_iter().eq(message.args().names())) {
                broken.insert(format!("{lang:?} {} {:?}", message.id(), message.args()));
            }
        }
    };
    for (request, _) in table() {
        for command in decode_request(request.as_bytes()) {
            check(bus::request(&command));
        }
    }
    for row in include_str!("../../crates/dcon/src/tests/vectors.txt").lines() {
        let cells: Vec<&str> = row.split('\t').collect();
        let [model, request, reply, _] = cells[..] else {
            continue;
        };
        for model in [None, Model::of_name(model)] {
            let frames = [request, reply].map(|it| format!("{it}\r").into_bytes());
            for (command, said) in dcon::interpret(&frames[0], &frames[1], false, model) {
                check(bus::reply(&command, &said, model));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn no_factory_command_can_be_written() {
    for (request, models) in table() {
        let never = models == [NEVER];
        let found = factory_command(request.as_bytes()).is_some();
        assert_eq!(found, never, "{request}");
        assert!(
            !never || decode_request(request.as_bytes()).is_empty(),
            "{request}"
        );
    }
}

// ---- the line task of the controller over a simulated bench ---------------------------------------------------------

/// Sends commands in order. Returns each result with the number of EEPROM writes so far.
fn exchanged(modules: &str, checksum: bool, commands: &[Command]) -> Vec<(Answer, u64)> {
    let exchange = async {
        let rig = SharedRig::new(bench::build_text(&format!("baud = 9600\n{modules}")).unwrap());
        let (_, plug) = wire::plugs(&rig).remove(0);
        let (ask, asked) = mpsc::channel(1);
        let (answer, mut answers) = mpsc::channel(1);
        let mut settings = LineSettings::new("bench", 9_600);
        settings.checksum = checksum;
        let pace = Pace::virtual_time();
        tokio::spawn(bus::run_reopening(
            bus::from_streams(move || plug.open()),
            settings,
            pace,
            asked,
            answer,
        ));
        let mut results = Vec::new();
        for command in commands {
            let request = Request {
                ticket: 0,
                command: *command,
                tries: 1,
            };
            ask.send(request).await.unwrap();
            let answer = answers.recv().await.unwrap();
            results.push((answer, rig.eeprom_writes()));
        }
        results
    };
    virtual_time::block_on(exchange).unwrap()
}

#[test]
fn an_unchanged_setting_is_not_written_to_the_eeprom() {
    let mut counted = 0;
    for model in models() {
        let module = format!("[[module]]\naddress = 1\nmodel = \"{model}\"");
        let rows = table().filter(|(_, models)| models.contains(&model));
        for (request, _) in rows {
            let mut settings = meant(model, request);
            settings.retain(|command| command.setting().is_some());
            let [command] = settings[..] else {
                continue;
            };
            let results = exchanged(&module, false, &[command, command]);
            let [(first, once), (second, twice)] = &results[..] else {
                panic!("{results:?}")
            };
            let name = format!("{model} {request}");
            assert_eq!(first.outcome, Ok(Reply::Accepted), "{name}");
            assert_eq!(second.outcome, Ok(Reply::Accepted), "{name}");
            assert_eq!(once, twice, "{name}: an unchanged setting was written");
            counted += once;
        }
    }
    assert!(
        counted > 40,
        "only {counted} settings differed and were written"
    );
}

#[test]
fn only_an_alarm_that_is_on_is_switched_off() {
    let zero = UpTo::new(0).unwrap();
    let asked = [
        Counter::EnableAlarmOf(zero),
        Counter::DisableAlarmOf(zero),
        Counter::DisableAlarmOf(zero),
    ];
    let module = "[[module]]\naddress = 1\nmodel = \"I-7080\"";
    let results = exchanged(module, false, &asked.map(|ask| ask.to(Address(1))));
    assert!(
        results
            .iter()
            .all(|(it, _)| it.outcome == Ok(Reply::Accepted))
    );
    let writes: Vec<u64> = results.iter().map(|(_, writes)| *writes).collect();
    assert_eq!(writes, [1, 2, 2]);
}

#[test]
fn a_silent_module_is_never_configured() {
    let mask = AnalogIn::WriteMask(0x0F).to(Address(1));
    let results = exchanged(
        "[[module]]\naddress = 2\nmodel = \"I-7017\"",
        false,
        &[mask],
    );
    let (answer, writes) = &results[0];
    let text = answer.outcome.as_ref().unwrap_err().to_string();
    assert!(text.contains("read the enabled inputs"), "{text}");
    assert_eq!((*writes, answer.command), (0, mask));
}

fn word(type_code: u8, baud: u32, format: u8) -> Config {
    Config {
        type_code: TypeCode(type_code),
        baud: BaudCode::of(baud).unwrap(),
        format: FormatByte(format),
    }
}

fn set(at: u8, address: u8, config: Config) -> Command {
    let address = Address(address);
    Common::WriteConfig { address, config }.to(Address(at))
}

/// Module in INIT*: stored address 04, 115200 baud, checksum; on the line address 00, 9600 baud, no checksum.
const GROUNDED: &str =
    "[[module]]\naddress = 4\nmodel = \"I-7017\"\nbaud = 115200\nchecksum = true\ninit = true";

#[test]
fn a_grounded_module_answers_at_00_with_stored_settings() {
    let name = Common::WriteName(ModuleName::new("NEST").unwrap()).to(Address(0));
    let asked = [
        Common::ReadInitPin.to(Address(4)),
        Common::ReadConfig.to(Address(0)),
        set(0, 4, word(0x08, 115_200, 0x40)),
        set(0, 4, word(0x08, 9_600, 0x00)),
        Common::ReadConfig.to(Address(0)),
        name,
    ];
    let results = exchanged(GROUNDED, false, &asked);
    let stored = |config| {
        Ok(Reply::Config {
            address: Address(4),
            config,
        })
    };
    assert_eq!(results[0].0.outcome, Ok(Reply::Flag(false)));
    assert_eq!(results[1].0.outcome, stored(word(0x08, 115_200, 0x40)));
    assert_eq!(
        (results[2].0.outcome.clone(), results[2].1),
        (Ok(Reply::Accepted), 0)
    );
    assert_eq!(
        (results[3].0.outcome.clone(), results[3].1),
        (Ok(Reply::Accepted), 1)
    );
    assert_eq!(results[4].0.outcome, stored(word(0x08, 9_600, 0x00)));
    // The reply carries the stored address 04, so that it is no answer of address 00.
    assert!(results[5].0.outcome.is_err(), "{:?}", results[5].0);
}

#[test]
fn rate_and_checksum_change_with_init_grounded_only() {
    let open = "[[module]]\naddress = 4\nmodel = \"I-7017\"";
    let changes = [
        set(4, 4, word(0x08, 115_200, 0x00)),
        set(4, 4, word(0x08, 9_600, 0x40)),
        set(4, 4, word(0x09, 9_600, 0x02)),
    ];
    let results = exchanged(open, false, &changes);
    for (answer, writes) in &results[..2] {
        let reason = ReplyError::Refused;
        assert!(
            matches!(&answer.outcome, Err(LineError { failure: Failure::Reply(it), .. }) if *it == reason),
            "{answer:?}"
        );
        assert_eq!(*writes, 0);
    }
    assert_eq!(
        (results[2].0.outcome.clone(), results[2].1),
        (Ok(Reply::Accepted), 1)
    );
}
