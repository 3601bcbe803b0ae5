//! `relayrig config`: checks files, prints schemas, revises recipes and shows who revised them; opens no port.

use super::output::Output;
use super::person;
use anyhow::{Context, anyhow};
use app::exit::Exit;
use config::schema::{FILES, of_file};
use config::{Change, ConfigError, Folder, Plant, overview};
use history::{Archive, RevisionEntry};
use page::access::audited;
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;
use texts::Lang;

/// Checks the configuration, prints a schema, revises a recipe.
#[derive(Debug, Clone, clap::Subcommand)]
pub enum Args {
    /// Check everything that loading would refuse, without moving anything
    #[command(
        after_help = "Examples:\n  relayrig config check\n  relayrig --config plant2 config check"
    )]
    Check,
    /// Print the JSON schema of a file: rig, golden, recipe, card, lot or instrument
    #[command(after_help = "Example:\n  relayrig config schema recipe > recipe.schema.json")]
    Schema {
        /// Which file
        #[arg(value_parser = FILES)]
        name: String,
    },
    /// Save the next revision of a recipe, which applies from the next run on, or a new recipe
    #[command(
        after_help = "Examples:\n  relayrig config revise jzc-22f-012 decision.slow_repeats=4 --by zhao --reason 'order 4711'\n  \
relayrig config revise jzc-22f-012 --save-as jzc-22f-012-a title_en='For customer A' --by zhao --reason 'customer A'"
    )]
    Revise(Revised),
    /// Approve the newest revision of a recipe as its second engineer; asks for the password, or reads the first line
    /// of stdin
    #[command(
        after_help = "Examples:\n  relayrig config approve jzc-22f-012 --by wang\n  \
relayrig config approve jzc-22f-012 --by wang < password.txt\n\n\
Lots need it where rig.toml has [recipes] approval = \"second_person\"."
    )]
    Approve {
        /// Name of the recipe
        recipe: String,
        /// Engineer who approves the revision
        #[arg(long, value_name = "NAME")]
        by: String,
    },
    /// Show who revised a recipe, when, why, and every key with its old and new value
    #[command(after_help = "Example:\n  relayrig config revisions jzc-22f-012 --json")]
    Revisions {
        /// Name of the recipe
        recipe: String,
        /// One JSON object per revision
        #[arg(long)]
        json: bool,
    },
}

/// New values of a recipe.
#[derive(Debug, Clone, clap::Args)]
pub struct Revised {
    /// Name of the recipe
    recipe: String,
    /// Path of a key and its new value; an empty value removes the key
    #[arg(required_unless_present = "save_as", value_name = "KEY=VALUE", value_parser = key_value)]
    values: Vec<(String, Value)>,
    /// Person who revises the recipe
    #[arg(long, value_name = "NAME")]
    by: String,
    /// Why the values change
    #[arg(long, value_name = "TEXT")]
    reason: String,
    /// Save a new recipe under this name; RECIPE stays as it is
    #[arg(long, value_name = "NAME")]
    save_as: Option<String>,
}

/// Parses `KEY=VALUE`: a value that is not valid JSON is a text, and an empty value is null, which removes the key.
fn key_value(text: &str) -> Result<(String, Value), KeyValueError> {
    let (key, value) = text.split_once('=').ok_or(KeyValueError)?;
    let value = match value {
        "" => Value::Null,
        text => serde_json::from_str(text).unwrap_or_else(|_| text.into()),
    };
    Ok((key.to_owned(), value))
}

/// Error: an argument is not `KEY=VALUE`.
#[derive(Debug, Clone, Copy, thiserror::Error)]
#[error("expected KEY=VALUE, for example decision.slow_repeats=4")]
struct KeyValueError;

/// Runs the command on the configuration in `folder` and the history in `db`.
///
/// # Errors
/// Fails with every fault of the configuration, and with the reason of a refused revision: exit status 2.
pub fn run(folder: &Folder, db: &Path, args: &Args) -> anyhow::Result<Exit> {
    let text = match args {
        Args::Check => overview(folder)?,
        Args::Revise(it) => revise(folder, db, it)?,
        Args::Approve { recipe, by } => {
            let password = super::password_of(by)?;
            let approved = page::approve_with_password(folder, db, recipe, (by, &password));
            let number = approved.map_err(|why| anyhow!("{}", why.say(Lang::En)))?;
            format!("revision {number} of {recipe} is approved by {by}\n")
        }
        Args::Revisions { recipe, json } => {
            config::revision(folder, recipe, None)?;
            let all = Archive::open(db)?.revisions(recipe)?;
            Output::stdout().lines(*json, &all, |it| json!(it), shown)?;
            return Ok(Exit::Done);
        }
        Args::Schema { name } => {
            let known = || format!("found {name:?}, expected one of {}", FILES.join(", "));
            let schema = of_file(name).with_context(known)?;
            serde_json::to_string_pretty(&schema).context("writing the schema")? + "\n"
        }
    };
    std::io::stdout()
        .lock()
        .write_all(text.as_bytes())
        .context("writing to stdout")?;
    Ok(Exit::Done)
}

/// Opens the audit of orders, saves a revision or a new recipe, and writes the change or its refusal into the audit.
fn revise(folder: &Folder, db: &Path, it: &Revised) -> anyhow::Result<String> {
    let by = person(&it.by)?;
    let change = Change {
        name: it.recipe.clone(),
        from: config::revision(folder, &it.recipe, None)?.hash,
        reason: it.reason.clone(),
        save_as: it.save_as.clone(),
        values: it.values.iter().cloned().collect(),
    };
    let plant = Plant::load(folder)?;
    let what = |saved: Option<&_>| change.audit(saved);
    let revise = || config::revise(&plant, &change);
    let saved = audited(db, by, what, ConfigError::message, revise)??;
    let lines = saved.changes.iter().map(|it| format!("  {it}\n"));
    Ok(format!(
        "revision {} of {}\n{}",
        saved.number,
        saved.name,
        lines.collect::<String>()
    ))
}

fn shown(it: &RevisionEntry) -> String {
    let role = if it.role.is_empty() {
        String::new()
    } else {
        format!(" ({})", it.role)
    };
    let lines: String = it.lines.iter().map(|line| format!("\n  {line}")).collect();
    format!(
        "revision {}, {}, {}{role}: {}{lines}",
        it.revision,
        it.at.local(),
        it.who,
        it.reason
    )
}
