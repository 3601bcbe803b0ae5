//! Prompts of a recipe or of `lot.toml`: what a person must do and answer before the lot continues.

use crate::rig::fault::Fault;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Instant of a lot at which a prompt opens; the machine rests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PromptMoment {
    /// Before the first motion of a run.
    LotStart,
    /// Before the references are measured, when a calibration is due.
    BeforeCalibration,
    /// Before the first part of a run, after the reference parts have left.
    AfterCalibration,
    /// After the last part of the lot.
    LotEnd,
    /// While a person loads or unloads a rack. The station makes this prompt; no recipe has it.
    #[serde(skip_deserializing)]
    Batch,
}

/// A prompt.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Prompt {
    /// Name in orders and in the record, unique within a lot.
    pub name: String,
    /// Instant at which it opens.
    pub when: PromptMoment,
    /// Request in English.
    pub text_en: String,
    /// Request in Chinese.
    pub text_zh: String,
    /// File in `config/pictures` that shows what to do; `None` without a picture.
    pub picture: Option<String>,
    /// Answers, at least one.
    pub choices: Vec<Choice>,
}

/// An answer to a prompt.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Choice {
    /// Name in orders and in the record, unique within the prompt.
    pub name: String,
    /// Label in English.
    pub text_en: String,
    /// Label in Chinese.
    pub text_zh: String,
    /// True when the answer stops the lot.
    #[serde(default)]
    pub stops: bool,
}

impl Prompt {
    /// Returns the choice of this name.
    pub fn choice(&self, name: &str) -> Option<&Choice> {
        self.choices.iter().find(|it| it.name == name)
    }
}

/// Checks that the names of prompts are unique, as are those of the choices of each, and that each prompt has a choice
/// with which the lot continues.
///
/// # Errors
/// Fails with the first key that breaks a rule.
pub fn check(prompts: &[Prompt]) -> Result<(), Fault> {
    for (place, prompt) in prompts.iter().enumerate() {
        let key = |field: &str| format!("prompt.{place}.{field}");
        let named = |name: &String| format!("\"{name}\"");
        if prompts[..place].iter().any(|it| it.name == prompt.name) {
            return Err(Fault::new(
                key("name"),
                named(&prompt.name),
                "a name of its own",
            ));
        }
        for (index, choice) in prompt.choices.iter().enumerate() {
            if prompt.choices[..index]
                .iter()
                .any(|it| it.name == choice.name)
            {
                let key = key(&format!("choices.{index}.name"));
                return Err(Fault::new(key, named(&choice.name), "a name of its own"));
            }
        }
        if prompt.choices.iter().all(|it| it.stops) {
            let expected = "a choice with which the lot goes on";
            return Err(Fault::new(key("choices"), "none that goes on", expected));
        }
    }
    Ok(())
}
