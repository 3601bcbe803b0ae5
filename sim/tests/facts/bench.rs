//! Tests of bench files: the documented example builds, and the error for every mistake names its place.

use rigsim::bench;

const DOCUMENT: &str = include_str!("../../../docs/bench.md");

fn example() -> &'static str {
    let after = DOCUMENT.split("```toml\n").nth(1).expect("an example");
    after.split("```").next().expect("an end")
}

fn refusal(text: &str) -> String {
    match bench::build_text(text) {
        Ok(_) => panic!("accepted: {text}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn the_documented_example_answers() {
    let mut rig = bench::build_text(example()).expect("the example");
    for (request, reply) in [
        (&b"#010"[..], "!>+05.123"),
        (b"$012", "!!01080A00"),
        (b"$026", "!!0202.500"),
        (b"#030", "!>0000001E"),
        (b"$038", "!!032"),
        (b"@04", "!>1179"),
        (b"$04L1", "!!000500"),
        (b"$04L0", "!!000200"),
        (b"$05M", "!!05SPARE"),
    ] {
        let found = rig.exchange(0, request, 0).expect("a reply").bytes;
        let found = format!("!{}", String::from_utf8_lossy(&found).trim_end());
        assert_eq!(found, reply, "{}", String::from_utf8_lossy(request));
    }
}

#[test]
fn the_document_names_every_key() {
    for model in ["I-7017F", "I-7021", "I-7080D", "I-7050"] {
        let file = format!("[[module]]\naddress = 1\nmodel = \"{model}\"\nnone = 1");
        let error = refusal(&file);
        let (_, keys) = error.split_once("expected one of ").expect("a list");
        for key in keys
            .split(", ")
            .filter(|key| !["address", "model"].contains(key))
        {
            assert!(DOCUMENT.contains(&format!("`{key}`")), "{model}: {key}");
        }
    }
}

#[test]
fn a_mistake_of_the_file_is_refused_with_its_place() {
    for (text, error) in [
        (
            "baud = 12345\n",
            "-:1: baud: found 12345, expected one of 1200, 2400, ",
        ),
        (
            "latency_ms = -2.0\n",
            "-:1: latency_ms: found -2.0, expected a number from 0 to 10000",
        ),
        (
            "latency_sd_ms = nan\n",
            "-:1: latency_sd_ms: found nan, expected a number from 0 to",
        ),
        (
            "baud = 9600\nspeed = 9600\n",
            "-:2: speed: found an unknown key, expected one of baud, ",
        ),
        ("baud = 9600 9600\n", "-:1: "),
    ] {
        let found = refusal(&format!(
            "{text}[[module]]\naddress = 1\nmodel = \"I-7017\"\n"
        ));
        assert!(found.starts_with(error), "{found}");
    }
    assert_eq!(
        refusal("baud = 9600"),
        "-:1: module: found nothing, expected a list"
    );
}

#[test]
fn a_mistake_of_a_module_is_refused_with_its_place() {
    for (model, line, error) in [
        (
            "I-7017",
            "inputs = [0, 0, 0, 0, 0, 0, 0, 0, 0]",
            "inputs: found [0, 0, 0, 0, 0, 0, 0, 0, 0], expected at most 8 ",
        ),
        (
            "I-7033",
            "inputs = [1, 2, 3, 4]",
            "inputs: found [1, 2, 3, 4], expected at most 3 ",
        ),
        (
            "I-7060",
            "inputs = [0, 2]",
            "inputs: found [0, 2], expected at most 4 levels 0 or 1",
        ),
        (
            "I-7080",
            "inputs = [-5]",
            "inputs: found [-5], expected at most 2 frequencies from 0 to 100000 Hz",
        ),
        (
            "I-7021",
            "inputs = [1]",
            "inputs: found an unknown key, expected one of address, baud, ",
        ),
        ("I-7043", "counts = [1]", "counts: found an unknown key, "),
        ("I-7080", "led = 1", "led: found an unknown key, "),
        ("I-7017", "slew = \"5\"", "slew: found an unknown key, "),
        ("I-7017", "rnage = \"08\"", "rnage: found an unknown key, "),
        (
            "I-7017",
            "range = \"99\"",
            "range: found \"99\", expected a type code of this model",
        ),
        (
            "I-7017",
            "range = 8",
            "range: found 8, expected hexadecimal text up to \"FF\"",
        ),
        (
            "I-7017",
            "type = \"09\"\nrange = \"08\"",
            "range: found \"08\", expected nothing beside `type`, ",
        ),
        (
            "I-7017",
            "fast = true",
            "fast: found true, expected false: this model has no fast mode",
        ),
        (
            "I-7017",
            "format = \"Hex\"",
            "format: found \"Hex\", expected one of engineering, percent, hex",
        ),
        (
            "I-7033",
            "mask = \"0F\"",
            "mask: found \"0F\", expected hexadecimal text, an integer or a list of 0 and 1 within \"7\"",
        ),
        (
            "I-7050",
            "outputs = [1, 2]",
            "outputs: found [1, 2], expected ",
        ),
        ("I-7067", "safe = \"80\"", "safe: found \"80\", expected "),
        (
            "I-7021",
            "safe = 11.0",
            "safe: found 11.0, expected at most 1 numbers from 0 to 10",
        ),
        (
            "I-7022",
            "type = \"99\"",
            "type: found \"99\", expected a type code of this model",
        ),
        (
            "I-7060",
            "latches = { hihg = 1 }",
            "latches.hihg: found an unknown key, expected one of high, low",
        ),
        (
            "I-7060",
            "watchdog = { timeout = 1 }",
            "watchdog.timeout: found an unknown key, expected one of enabled, ",
        ),
        (
            "I-7060",
            "watchdog = { timeout_s = 60 }",
            "watchdog.timeout_s: found 60, expected a number from 0.1 to 25.5",
        ),
        (
            "I-7060",
            "watchdog = 5",
            "watchdog: found 5, expected true, false or a table",
        ),
        (
            "I-7060",
            "baud = 12345",
            "baud: found 12345, expected one of ",
        ),
        (
            "I-7060",
            "name = \"TOOLONG\"",
            "name: found \"TOOLONG\", expected text of 1 to 6 characters",
        ),
        (
            "I-7060",
            "response_delay_ms = 31",
            "response_delay_ms: found 31, expected a number from 0 to 30",
        ),
        (
            "I-7080",
            "preset = [1.5]",
            "preset: found [1.5], expected at most 2 whole numbers from 0 to 4294967295",
        ),
        (
            "I-7080",
            "gate = 3",
            "gate: found 3, expected low, high, none, 0, 1 or 2",
        ),
        (
            "I-7080",
            "input_mode = 1.5",
            "input_mode: found 1.5, expected ",
        ),
        (
            "I-9999",
            "",
            "model: found \"I-9999\", expected one of 7017 ",
        ),
    ] {
        let text = format!("[[module]]\nmodel = \"{model}\"\naddress = 1\n{line}\n");
        let found = refusal(&text);
        let number = if line.is_empty() {
            2
        } else {
            3 + line.lines().count()
        };
        let expected = format!("-:{number}: module[0].{error}");
        assert!(found.starts_with(&expected), "{found}\n{expected}");
    }
    let address = refusal("[[module]]\naddress = 256\nmodel = \"I-7017\"\n");
    assert_eq!(
        address,
        "-:2: module[0].address: found 256, expected a whole number from 0 to 255"
    );
}
