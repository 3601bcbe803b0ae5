//! `relayrig plan`: what blocks the elements of a scene, and in which sequence they come off and go on; needs no rig.
//!
//! Exit status: 0 a sequence exists, 1 no sequence exists (the answer names the locked set), 2 bad input.

use super::history::paper::{LangArg, write_page};
use super::output::Output;
use ::config::{Folder, SCENE};
use ::history::inquiry::paper::paper;
use ::history::report::plan::sheet;
use ::history::tooling::{ChangeoverRow, PlanAction, PlanStep};
use ::plan::{Demands, Direction, Extent};
use anyhow::ensure;
use app::exit::Exit;
use app::planning::{LockedRow, PlanScene, Planning, changeover, interference, order};
use clap::{Args, Subcommand};
use serde_json::json;
use std::path::PathBuf;
use texts::{Lang, Message};

/// Interference tables and sequences of a scene, without a rig.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  relayrig plan interference
  relayrig plan disassembly --remove probe_housing --stay 'baseplate*'
  relayrig plan assembly --scene fixture.toml --forbid=-y --json
  relayrig plan changeover --from config/scene.toml --to config/nests/body-18x12.toml --out changeover.html

Exit status: 0 an order exists, 1 none does, 2 bad input.")]
pub struct PlanArgs {
    #[command(subcommand)]
    question: Question,
}

#[derive(Debug, Subcommand)]
enum Question {
    /// What blocks each element in each of six directions
    #[command(after_help = "Example: relayrig plan interference --scene fixture.toml --json")]
    Interference(InterferenceArgs),
    /// In which order elements come off
    #[command(after_help = "Example: relayrig plan disassembly --remove gripper_palm")]
    Disassembly(DisassemblyArgs),
    /// In which order elements go on
    #[command(after_help = "Example: relayrig plan assembly --stay 'baseplate*'")]
    Assembly(AssemblyArgs),
    /// What stays, goes and comes from one scene to another, in order
    #[command(after_help = "Example: relayrig plan changeover --from small.toml --to large.toml")]
    Changeover(ChangeoverArgs),
}

/// The scene, and the form of the answer.
#[derive(Debug, Args)]
struct SceneArgs {
    /// Scene, TOML or JSON by its extension [default: scene.toml of the configuration]
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    form: FormArgs,
}

/// Space and form of an answer.
#[derive(Debug, Args)]
struct FormArgs {
    /// Space that elements leave: x,y,z of its least and of its greatest corner, mm [default: the box around all
    /// elements]
    #[arg(
        long,
        value_name = "MM",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    omega: Option<Vec<f64>>,
    /// One JSON object per row instead of text
    #[arg(long)]
    json: bool,
    /// Language of the text; when absent, that of the locale (LC_ALL, LC_MESSAGES, LANG), else en
    #[arg(long, value_enum)]
    lang: Option<LangArg>,
}

/// Demands on a sequence, and the file for its print.
#[derive(Debug, Args)]
struct DemandArgs {
    /// HTML file to write instead of text, for A4: a step per row, drawn from above and from the front; - is stdout
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    out: Option<PathBuf>,
    /// Element that stays; a * at its end stands for any ending
    #[arg(long, value_name = "ID")]
    stay: Vec<String>,
    /// Elements that move as one, separated by commas
    #[arg(long, value_name = "IDS")]
    group: Vec<String>,
    /// Direction in which nothing leaves, such as the operator's side
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true)]
    forbid: Vec<Direction>,
    /// Only straight ways of single elements and groups: no ways of two steps, no subassemblies
    #[arg(long)]
    straight: bool,
    /// Nothing comes off while another element rests on it
    #[arg(long)]
    supported: bool,
}

#[derive(Debug, Args)]
struct InterferenceArgs {
    #[command(flatten)]
    scene: SceneArgs,
}

#[derive(Debug, Args)]
struct DisassemblyArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Element that must come off; nothing else comes off but what is in its way [default: everything that does not
    /// stay]
    #[arg(long, value_name = "ID")]
    remove: Vec<String>,
    #[command(flatten)]
    demands: DemandArgs,
}

#[derive(Debug, Args)]
struct AssemblyArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    demands: DemandArgs,
}

#[derive(Debug, Args)]
struct ChangeoverArgs {
    /// Scene before the change
    #[arg(long, value_name = "FILE")]
    from: PathBuf,
    /// Scene after the change
    #[arg(long, value_name = "FILE")]
    to: PathBuf,
    #[command(flatten)]
    form: FormArgs,
    #[command(flatten)]
    demands: DemandArgs,
}

impl DemandArgs {
    fn demands(&self, remove: &[String]) -> Demands {
        let ids = |list: &String| list.split(',').map(|id| id.trim().to_owned()).collect();
        Demands {
            remove: remove.to_vec(),
            stay: self.stay.clone(),
            groups: self.group.iter().map(ids).collect(),
            forbidden: self.forbid.clone(),
            straight_only: self.straight,
            keeps_supports: self.supported,
        }
    }
}

impl FormArgs {
    fn lang(&self) -> Lang {
        LangArg::or_locale(self.lang)
    }

    fn omega(&self) -> anyhow::Result<Option<Extent>> {
        let Some(corners) = &self.omega else {
            return Ok(None);
        };
        let [a, b, c, d, e, f] = corners[..] else {
            anyhow::bail!("--omega: found {} numbers, expected 6", corners.len());
        };
        let (low, high) = ([a, b, c], [d, e, f]);
        let is_box = (0..3).all(|axis| low[axis] < high[axis] && high[axis] - low[axis] <= 1e6);
        ensure!(
            is_box,
            "--omega: found {low:?} to {high:?}, expected each number of the first corner below that of the second, \
             at most 1e6 mm apart"
        );
        Ok(Some(Extent { low, high }))
    }
}

impl SceneArgs {
    fn load(&self, config: &Folder) -> anyhow::Result<PlanScene> {
        let omega = self.form.omega()?;
        match &self.scene {
            Some(path) => PlanScene::load(path, omega),
            None => {
                config.check_exists()?;
                PlanScene::of_folder(config, SCENE, omega)
            }
        }
    }
}

/// Runs the command and returns [`Exit::Done`], or [`Exit::AnswerIsNo`] when no sequence exists.
///
/// # Errors
/// Fails on bad input before any output; the caller reports the chain and exits with 2.
pub fn run(config: &Folder, args: &PlanArgs) -> anyhow::Result<Exit> {
    match &args.question {
        Question::Interference(args) => {
            let rows = interference(&args.scene.load(config)?)?;
            let form = &args.scene.form;
            let lines: Vec<String> = if form.json {
                rows.iter().map(|row| json!(row).to_string()).collect()
            } else {
                rows.iter().filter_map(|row| row.say(form.lang())).collect()
            };
            print(&lines)?;
            Ok(Exit::Done)
        }
        Question::Disassembly(args) => {
            let demands = args.demands.demands(&args.remove);
            let planning = order(&args.scene.load(config)?, &demands, PlanAction::Remove)?;
            answered(&planning, &args.demands, &args.scene.form)
        }
        Question::Assembly(args) => {
            let demands = args.demands.demands(&[]);
            let planning = order(&args.scene.load(config)?, &demands, PlanAction::Add)?;
            answered(&planning, &args.demands, &args.scene.form)
        }
        Question::Changeover(args) => {
            let omega = args.form.omega()?;
            let from = PlanScene::load(&args.from, omega)?;
            let to = PlanScene::load(&args.to, omega)?;
            let planning = changeover(&from, &to, &args.demands.demands(&[]))?;
            answered(&planning, &args.demands, &args.form)
        }
    }
}

fn answered(planning: &Planning, args: &DemandArgs, form: &FormArgs) -> anyhow::Result<Exit> {
    let plan = match planning {
        Planning::Plan(plan) => plan,
        Planning::Locked(locked) => return told_locked(locked, form),
    };
    if let Some(out) = &args.out {
        write_page(out, &sheet(&paper(form.lang()), plan))?;
        return Ok(Exit::Done);
    }
    let summary = plan.summary.as_ref();
    let mut lines = summary.map_or(Vec::new(), |it| of_summary(it, form));
    lines.extend(of_steps(&plan.steps, form));
    print(&lines)?;
    Ok(Exit::Done)
}

fn of_steps(steps: &[PlanStep], form: &FormArgs) -> Vec<String> {
    let line = |step: &PlanStep| match form.json {
        true => json!(step).to_string(),
        false => step.say(form.lang()),
    };
    steps.iter().map(line).collect()
}

fn of_summary(summary: &ChangeoverRow, form: &FormArgs) -> Vec<String> {
    if form.json {
        return vec![json!(summary).to_string()];
    }
    let lang = form.lang();
    let groups = [
        ("stays", &summary.stays),
        ("goes", &summary.goes),
        ("comes", &summary.comes),
        ("returns", &summary.returns),
    ];
    let named = groups.into_iter().filter(|(_, ids)| !ids.is_empty());
    named
        .map(|(code, ids)| {
            Message::new("plan", code)
                .with("elements", ids.join(lang.comma()))
                .say(lang)
        })
        .collect()
}

fn told_locked(locked: &LockedRow, form: &FormArgs) -> anyhow::Result<Exit> {
    print(&match form.json {
        true => vec![json!(locked).to_string()],
        false => locked.say(form.lang()),
    })?;
    Ok(Exit::AnswerIsNo)
}

fn print(lines: &[String]) -> anyhow::Result<()> {
    Ok(Output::stdout().lines(false, lines, |it| json!(it), Clone::clone)?)
}
