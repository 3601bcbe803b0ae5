//! Prompts of a recipe, answered on the command line.

use crate::program::Workshop;

const RUN: &str = "run --sim --seed 1 --recipe resistor-390 --count 2 --json";
const PROMPTS: &str = r#"
[[prompt]]
name = "nest"
when = "lot_start"
text_en = "Change the nest"
text_zh = "更换测试位"
choices = [
  { name = "changed", text_en = "Changed", text_zh = "已更换" },
  { name = "stop", text_en = "Stop the lot", text_zh = "停止批次", stops = true },
]

[[prompt]]
name = "magazine"
when = "lot_end"
text_en = "Empty the magazine"
text_zh = "清空料道"
choices = [{ name = "emptied", text_en = "Emptied", text_zh = "已清空" }]
"#;

fn plant(name: &str) -> Workshop {
    let workshop = Workshop::new(name);
    let recipe = "config/recipes/resistor-390.toml";
    let text = workshop.read(recipe);
    workshop.write(recipe, &format!("{text}{PROMPTS}"));
    workshop
}

#[test]
fn the_orders_of_a_lot_hold_its_answers() {
    let workshop = plant("prompts_answered");
    let answers = "--answer nest=changed --answer magazine=emptied --by li";
    workshop
        .run(&format!("{RUN} --lot A {answers}"))
        .with_status(0);
    let orders = workshop.run("history orders --lot A --json").with_status(0);
    let given: Vec<String> = orders
        .objects()
        .into_iter()
        .filter(|it| it["what"]["order"] == "answer" && it["who"] == "li")
        .map(|it| format!("{}={}", it["what"]["prompt"], it["what"]["choice"]))
        .collect();
    assert_eq!(given, ["\"nest\"=\"changed\"", "\"magazine\"=\"emptied\""]);
    let report = workshop
        .run("history report --lot A --lang en")
        .with_status(0);
    assert!(report.stdout.contains(
        "<td class=\"text\">nest</td><td class=\"text\">changed</td><td class=\"text\">li</td>"
    ));
}

#[test]
fn a_stopping_answer_leaves_the_lot_open() {
    let workshop = plant("prompts_stopped");
    let answers = "--answer nest=stop --answer magazine=emptied --by li";
    let said = workshop
        .run(&format!("{RUN} --lot A {answers}"))
        .with_status(4);
    assert!(said.stdout.contains("\"parts\":0"), "{said}");
    let shown = workshop.run("lot show A").with_status(0);
    assert!(shown.stdout.starts_with("lot A open"), "{shown}");
}

#[test]
fn a_run_without_its_answers_is_refused() {
    let workshop = plant("prompts_refused");
    for (answers, found) in [
        ("", "found no answer for prompt \"nest\""),
        (
            "--answer nest=perhaps --by li",
            "found \"perhaps\" for prompt \"nest\"",
        ),
        ("--answer door=shut --by li", "found \"door\""),
        (
            "--answer nest=changed --answer nest=stop --by li",
            "prompt \"nest\" twice",
        ),
    ] {
        let said = workshop
            .run(&format!("{RUN} --lot A {answers}"))
            .with_status(2);
        assert!(said.stderr.contains(found), "{said}");
        assert!(!workshop.folder.join("relayrig.db").exists(), "{said}");
    }
}

#[test]
fn a_prompt_without_its_picture_is_refused() {
    let workshop = plant("prompts_picture");
    let recipe = "config/recipes/resistor-390.toml";
    let pictured = "when = \"lot_end\"\npicture = \"track.png\"";
    workshop.change(recipe, "when = \"lot_end\"", pictured);
    let said = workshop.run("config check").with_status(2);
    assert!(
        said.stderr
            .contains("prompt[1].picture: found \"track.png\""),
        "{said}"
    );
    std::fs::create_dir(workshop.folder.join("config/pictures")).unwrap();
    workshop.write("config/pictures/track.png", "");
    workshop.run("config check").with_status(0);
}
