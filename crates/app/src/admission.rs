//! Checks that a lot may run, before the program opens a port or moves anything.

use super::answers::Answers;
use super::calibration;
use super::exit::Cause;
use super::lot::Purpose;
use super::order::LotOrder;
use super::source::RigSource;
use config::{Approval, ConfigError, Plant, load_recipe};
use history::{
    AlarmRecord, Archive, HistoryError, LOT_NAME, LotRecord, LotState, LotStatus, Row,
    RunEndRecord, SIGNATURES, Store, is_lot_name, signatures,
};
use machine::dut::Recipe;
use machine::dut::prompt::Prompt;
use machine::handling::serial::SourceName;
use machine::station::trouble::Alarm;
use machine::station::turn::Ending;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use texts::{Lang, Message};

/// Reason why a lot is refused. The text, for the command line, names the option that is wrong.
#[derive(Debug, thiserror::Error)]
pub enum AdmissionError {
    /// The lot's name has characters or a length that the history does not allow.
    #[error("--lot: found {found:?}, expected {LOT_NAME}")]
    Name {
        /// Name as given.
        found: String,
    },
    /// The lot has zero parts.
    #[error("--count: found 0, expected at least 1")]
    NoParts,
    /// The recipe is missing or invalid, or this plant cannot measure it.
    #[error(transparent)]
    Recipe(#[from] ConfigError),
    /// The plant requires approval of the recipe by a second engineer, and too few engineers have saved or approved it.
    #[error(
        "--recipe: found {recipe} with {found} of {SIGNATURES} engineers who saved or approved it, expected an approved \
         recipe (page Recipes, or relayrig config approve)"
    )]
    NotApproved {
        /// Name of the recipe.
        recipe: String,
        /// Number of engineers who saved or approved it.
        found: usize,
    },
    /// The order is a retest of a lot that never ran.
    #[error("--retest: found no run of lot \"{lot}\", expected a lot to test again")]
    NothingToRetest {
        /// Name of the lot.
        lot: String,
    },
    /// The lot is on hold until a person releases it.
    #[error(
        "--lot: \"{lot}\" is held since {}: {}; expected a lot that may be run (relayrig lot release)",
        standing.since,
        standing.why.as_deref().unwrap_or_default()
    )]
    Held {
        /// Name of the lot.
        lot: String,
        /// State of the lot, with the instant and the reason of the hold.
        standing: Box<LotStatus>,
    },
    /// The lot is complete and the order is no retest.
    #[error(
        "--lot: \"{lot}\" is complete since {}; expected another lot, or --retest (relayrig lot reopen opens it again)",
        standing.since
    )]
    Complete {
        /// Name of the lot.
        lot: String,
        /// State of the lot, with the instant at which it became complete.
        standing: Box<LotStatus>,
    },
    /// The lot began with another recipe.
    #[error(
        "--recipe: found {found}, expected {} {}, with which lot \"{lot}\" began and which it keeps; name another lot",
        standing.recipe,
        standing.recipe_hash.get(..12).unwrap_or_default()
    )]
    OtherRecipe {
        /// Name of the lot.
        lot: String,
        /// Recipe that the order names: its name and the first 12 characters of its hash.
        found: String,
        /// State of the lot, and the recipe with which the lot began.
        standing: Box<LotStatus>,
    },
    /// A person must scan the parts of the lot, but the run has no screen.
    #[error(
        "--lot: lot.toml has `source = \"wedge\"`; expected a lot at the page (relayrig serve), where a person scans each part"
    )]
    NeedsScreen,
    /// A run without a screen has no answer to a prompt, or an answer that is none of the prompt's choices.
    #[error(
        "--answer: found {found} for prompt \"{prompt}\", expected {prompt}=CHOICE, one of {choices} (or a lot at the page)"
    )]
    Unanswered {
        /// Name of the prompt.
        prompt: String,
        /// Answer as given.
        found: String,
        /// Names of the prompt's choices.
        choices: String,
    },
    /// An answer belongs to no prompt of the lot.
    #[error("--answer: found \"{found}\", expected a prompt of recipe or lot.toml")]
    NoSuchPrompt {
        /// Name as given.
        found: String,
    },
    /// A prompt has two answers.
    #[error("--answer: found prompt \"{prompt}\" twice, expected one answer for it")]
    AnsweredTwice {
        /// Name of the prompt.
        prompt: String,
    },
    /// The history cannot be read.
    #[error(transparent)]
    History(#[from] HistoryError),
}

impl AdmissionError {
    /// Returns the refusal as a message for the page.
    pub fn screen_message(&self) -> Message {
        let refusal = |code| Message::new("refusal", code);
        match self {
            Self::Name { .. } => refusal("lot_name"),
            Self::NoParts => refusal("lot_without_parts"),
            Self::Held { lot, standing } => refusal("lot_held")
                .with("lot", lot)
                .with("why", standing.why.as_deref().unwrap_or_default()),
            Self::Complete { lot, .. } => refusal("lot_completed").with("lot", lot),
            Self::NotApproved { recipe, .. } => refusal("not_approved").with("recipe", recipe),
            Self::OtherRecipe { lot, standing, .. } => refusal("other_recipe")
                .with("lot", lot)
                .with("recipe", &standing.recipe),
            Self::NothingToRetest { lot } => refusal("nothing_to_retest").with("lot", lot),
            Self::Recipe(_) => refusal("recipe_faulty").with("said", self),
            Self::NeedsScreen
            | Self::Unanswered { .. }
            | Self::NoSuchPrompt { .. }
            | Self::AnsweredTwice { .. } => refusal("needs_screen"),
            Self::History(_) => refusal("program_trouble").with("said", self),
        }
    }
}

/// Checks that a lot may run; returns its recipe.
///
/// # Errors
/// Fails on an invalid name or zero parts; on a recipe that is faulty, lacks a required approval, or cannot be measured
/// on this plant; on a lot that is held, began with another recipe, or is complete while the order is no retest; on a
/// retest of a lot that never ran; and when the history cannot be read.
pub fn admit(
    db: &Path,
    plant: &Plant,
    order: &LotOrder,
    purpose: Purpose,
) -> Result<Arc<Recipe>, AdmissionError> {
    if !is_lot_name(&order.lot) {
        let found = order.lot.clone();
        return Err(AdmissionError::Name { found });
    }
    if order.count == Some(0) && purpose == Purpose::Lot {
        return Err(AdmissionError::NoParts);
    }
    let recipe = load_recipe(&plant.folder, &order.recipe)?;
    plant.admit(&recipe)?;
    if purpose == Purpose::Lot {
        check_approval(db, plant, &recipe)?;
        check_lot_state(db, &recipe, order)?;
    }
    Ok(Arc::new(recipe))
}

fn check_approval(db: &Path, plant: &Plant, recipe: &Recipe) -> Result<(), AdmissionError> {
    match config::approval(&plant.folder)? {
        Approval::None => return Ok(()),
        Approval::SecondPerson => {}
    }
    let found = signatures(db, &recipe.name, &recipe.hash)?.len();
    if found < SIGNATURES {
        let recipe = recipe.name.clone();
        return Err(AdmissionError::NotApproved { recipe, found });
    }
    Ok(())
}

/// Checks that a run without a screen can carry out a lot.
///
/// # Errors
/// Fails when a person must scan the parts, when a prompt has no answer or two, and for an answer that fits no prompt.
pub fn check_unattended(
    plant: &Plant,
    recipe: &Recipe,
    answers: &Answers,
) -> Result<(), AdmissionError> {
    let source = plant.lot.serial.as_ref().map(|it| it.source);
    if source == Some(SourceName::Wedge) {
        return Err(AdmissionError::NeedsScreen);
    }
    let prompts = || plant.prompts(recipe);
    let unknown = |(name, _): &&(String, String)| !prompts().any(|it| it.name == *name);
    if let Some((found, _)) = answers.given.iter().find(unknown) {
        let found = found.clone();
        return Err(AdmissionError::NoSuchPrompt { found });
    }
    let mut names = BTreeSet::new();
    if let Some((prompt, _)) = answers.given.iter().find(|it| !names.insert(&it.0)) {
        let prompt = prompt.clone();
        return Err(AdmissionError::AnsweredTwice { prompt });
    }
    let answer = |it: &Prompt| answers.choice(it).map(str::to_owned);
    let fits = |it: &&Prompt| answer(it).is_some_and(|choice| it.choice(&choice).is_some());
    let Some(prompt) = prompts().find(|it| !fits(it)) else {
        return Ok(());
    };
    let choices = prompt.choices.iter().map(|it| it.name.as_str());
    Err(AdmissionError::Unanswered {
        prompt: prompt.name.clone(),
        found: answer(prompt).map_or("no answer".to_owned(), |it| format!("\"{it}\"")),
        choices: choices.collect::<Vec<_>>().join(", "),
    })
}

/// Returns the state of a lot; `None` for a lot without runs and for a missing history.
pub(super) fn standing(db: &Path, lot: &str) -> Result<Option<LotStatus>, HistoryError> {
    match db.exists() {
        true => Archive::open(db)?.standing(lot),
        false => Ok(None),
    }
}

fn check_lot_state(db: &Path, recipe: &Recipe, order: &LotOrder) -> Result<(), AdmissionError> {
    let lot = order.lot.clone();
    let Some(standing) = standing(db, &lot)?.map(Box::new) else {
        return match order.retest {
            Some(_) => Err(AdmissionError::NothingToRetest { lot }),
            None => Ok(()),
        };
    };
    match standing.state {
        LotState::Held => Err(AdmissionError::Held { lot, standing }),
        LotState::Open | LotState::Running | LotState::Complete
            if standing.recipe_hash != recipe.hash =>
        {
            Err(AdmissionError::OtherRecipe {
                lot,
                found: format!("{} {}", recipe.name, &recipe.hash[..12]),
                standing,
            })
        }
        LotState::Complete if order.retest.is_none() => {
            Err(AdmissionError::Complete { lot, standing })
        }
        LotState::Open | LotState::Running | LotState::Complete => Ok(()),
    }
}

/// Returns why a lot of this recipe must wait for a calibration of the rig; `None` when the lot may run, and always on
/// a simulated rig, which calibrates before every lot.
///
/// # Errors
/// Fails when the history cannot be read.
pub fn calibration_refusal(
    (db, plant): (&Path, &Plant),
    recipe: &Recipe,
    source: &RigSource,
) -> anyhow::Result<Option<Message>> {
    if source.is_simulated() {
        return Ok(None);
    }
    match recipe.device.calibrated_for() {
        Some(nominal_v) => {
            let of_plant = calibration::of_plant(plant, &recipe.device, false);
            calibration::refusal(db, nominal_v, of_plant.as_ref())
        }
        None => Ok(None),
    }
}

/// Records a run without parts, with an alarm that says why the rig refused the lot; returns the cause for the exit
/// status.
///
/// # Errors
/// Fails when the history cannot be written.
pub fn refuse(
    db: &Path,
    recipe: &Recipe,
    order: &LotOrder,
    why: &Message,
) -> anyhow::Result<Cause> {
    let mut store = Store::open(db)?;
    let now_us = jiff::Timestamp::now().as_microsecond();
    store.begin_lot(&LotRecord {
        lot: order.lot.clone(),
        recipe: recipe.name.clone(),
        recipe_snapshot: recipe.source_text.clone(),
        recipe_hash: recipe.hash.clone(),
        opened_at_us: now_us,
        retest: order.retest.clone(),
        ..LotRecord::default()
    })?;
    let alarm = Alarm::calibration_invalid(why);
    let cause = Cause::from(&alarm);
    let alarm = Row::Alarm(AlarmRecord {
        lot: Some(order.lot.clone()),
        code: alarm.code.name(),
        text: alarm.text(Lang::En),
        args: alarm.args,
        raised_at_us: now_us,
        ..AlarmRecord::default()
    });
    let ended = Row::RunEnded(RunEndRecord {
        lot: order.lot.clone(),
        ended: Ending::Alarm,
        cause: Some((cause.code.clone(), cause.text.clone())),
    });
    store.record(&[alarm, ended])?;
    store.close_lot(&order.lot, now_us)?;
    Ok(cause)
}
