//! `relayrig user`: names, roles and passwords of the people who may log in at the screen.
//!
//! The audit of orders records every change with the name of the person who made it, as for a change at the page.

use super::output::{Column, FormatArgs, Output, text};
use super::{password_of, person};
use app::exit::Exit;
use history::Moment;
use page::access::{AccessError, Entry, PersonChange, Register, Role, access_path, audited};
use std::path::Path;

/// People who may log in at the screen.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig user list
  relayrig user add li --role operator
  relayrig user role li maintainer
  relayrig user password li --stdin < new-password.txt
  relayrig user unlock li
  relayrig user remove li

Without --stdin the program makes a random password and prints it once. The register lies beside the history (--db);
`history orders --order people` lists its changes, `history orders --order login` wrong passwords.")]
pub struct UserArgs {
    /// Person who makes the change [default: the account of the system]
    #[arg(long, global = true, value_name = "NAME")]
    by: Option<String>,
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// List names and roles, and who waits because of wrong passwords
    List(FormatArgs),
    /// Add a person
    Add {
        /// Letters, digits, `.`, `-`, `_`
        name: String,
        /// operator, maintainer or engineer
        #[arg(long)]
        role: Role,
        /// Ask for the password at the terminal, or read the first line of stdin
        #[arg(long)]
        stdin: bool,
    },
    /// Give a person another role
    Role {
        /// Name of the person
        name: String,
        /// operator, maintainer or engineer
        role: Role,
    },
    /// Give a new password and end the person's sessions
    Password {
        /// Name of the person
        name: String,
        /// Ask for the password at the terminal, or read the first line of stdin
        #[arg(long)]
        stdin: bool,
    },
    /// Forget the wrong passwords of a person, who may then log in at once
    Unlock {
        /// Name of the person
        name: String,
    },
    /// Remove a person
    Remove {
        /// Name of the person
        name: String,
    },
}

const COLUMNS: [Column<Entry>; 4] = [
    ("role", |it| it.person.role.to_string()),
    ("name", |it| it.person.name.clone()),
    ("since", |it| it.since.local()),
    ("locked_until", |it| {
        text(it.locked_until.map(Moment::local))
    }),
];

/// Runs `relayrig user`; an error is bad input (exit status 2).
pub fn run(db: &Path, args: UserArgs) -> anyhow::Result<Exit> {
    let mut register = Register::open(&access_path(db))?;
    let now_us = jiff::Timestamp::now().as_microsecond();
    let change = match args.action {
        Action::List(format) => {
            let people = register.entries(now_us)?;
            Output::stdout().list(format.format(), &people, &COLUMNS)?;
            return Ok(Exit::Done);
        }
        Action::Add { name, role, stdin } => PersonChange::Add {
            password: password(stdin, &name)?,
            name,
            role,
        },
        Action::Role { name, role } => PersonChange::Role { name, role },
        Action::Password { name, stdin } => PersonChange::Password {
            password: password(stdin, &name)?,
            name,
        },
        Action::Unlock { name } => PersonChange::Unlock { name },
        Action::Remove { name } => PersonChange::Remove { name },
    };
    let by = person(&args.by.unwrap_or_else(account))?;
    let work = || change.apply(&mut register, now_us);
    let drawn = audited(db, by, |_| change.what(), AccessError::message, work)??;
    if let (Some(drawn), PersonChange::Add { name, .. } | PersonChange::Password { name, .. }) =
        (drawn, change)
    {
        println!("{name} logs in with {drawn}");
    }
    Ok(Exit::Done)
}

/// Returns the name of the account that calls the program; under sudo, of the account that called sudo.
fn account() -> String {
    let through_sudo = std::env::var("SUDO_USER").ok().filter(|it| !it.is_empty());
    through_sudo.unwrap_or_else(app::doctor::own_account)
}

fn password(from_stdin: bool, who: &str) -> anyhow::Result<Option<String>> {
    from_stdin.then(|| password_of(who)).transpose()
}
