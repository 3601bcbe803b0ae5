//! `relayrig user`: names, roles and passwords of the people who may log in at the screen.

use anyhow::Context;
use app::exit::Exit;
use page::access::{Register, Role, access_path};
use std::io::{BufRead, Write};
use std::path::Path;

/// People who may log in at the screen.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig user list
  relayrig user add li --role operator
  relayrig user password li --stdin < new-password.txt
  relayrig user remove li

Without --stdin the program makes a random password and prints it once. The register lies beside the history (--db).")]
pub struct UserArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// List names and roles
    List,
    /// Add a person
    Add {
        /// Letters, digits, `.`, `-`, `_`
        name: String,
        /// operator, maintainer or engineer
        #[arg(long)]
        role: Role,
        /// Read the password from the first line of stdin
        #[arg(long)]
        stdin: bool,
    },
    /// Give a new password and end the person's sessions
    Password {
        /// Name of the person
        name: String,
        /// Read the password from the first line of stdin
        #[arg(long)]
        stdin: bool,
    },
    /// Remove a person
    Remove {
        /// Name of the person
        name: String,
    },
}

/// Runs the command.
pub fn run(db: &Path, args: UserArgs) -> anyhow::Result<Exit> {
    let mut register = Register::open(&access_path(db))?;
    match args.action {
        Action::List => {
            for person in register.people()? {
                writeln!(std::io::stdout(), "{:<12}{}", person.role, person.name)?;
            }
        }
        Action::Add { name, role, stdin } => {
            let password = password(stdin)?;
            let now_us = jiff::Timestamp::now().as_microsecond();
            register.add(&name, role, &password, now_us)?;
            print_login(&name, &password, stdin);
        }
        Action::Password { name, stdin } => {
            let password = password(stdin)?;
            register.set_password(&name, &password)?;
            print_login(&name, &password, stdin);
        }
        Action::Remove { name } => register.remove(&name)?,
    }
    Ok(Exit::Done)
}

fn password(from_stdin: bool) -> anyhow::Result<String> {
    if !from_stdin {
        return Ok(Register::random_password()?);
    }
    let mut line = String::new();
    std::io::stdin()
        .lock()
        .read_line(&mut line)
        .context("reading the password from stdin")?;
    Ok(line.trim_end_matches(['\r', '\n']).to_owned())
}

/// Prints name and random password; prints nothing when the password was chosen, because the person knows it.
fn print_login(name: &str, password: &str, chosen: bool) {
    if !chosen {
        println!("{name} logs in with {password}");
    }
}
