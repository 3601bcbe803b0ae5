//! Writes man pages and shell completions for a package; a program of its own, so that `relayrig` contains no
//! generator.

use anyhow::Context;
use clap::{CommandFactory, Parser};
use clap_complete::Shell;
use relayrig::cli::Cli;
use std::fs;
use std::path::{Path, PathBuf};

/// Writes a man page for each command and completions for bash, zsh and fish.
#[derive(Debug, Parser)]
struct Args {
    /// Folder to fill; created if missing
    folder: PathBuf,
}

fn main() -> anyhow::Result<()> {
    write(&Args::parse().folder)
}

fn write(folder: &Path) -> anyhow::Result<()> {
    let named = || folder.display().to_string();
    let pages = folder.join("man");
    fs::create_dir_all(&pages).with_context(named)?;
    clap_mangen::generate_to(Cli::command(), &pages).with_context(named)?;
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
        clap_complete::generate_to(shell, &mut Cli::command(), "relayrig", folder)
            .with_context(named)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Returns the file names of a command's page and of the pages of all its subcommands.
    fn pages(command: &clap::Command, name: &str) -> Vec<String> {
        let below = command.get_subcommands().filter(|it| !it.is_hide_set());
        let below = below.flat_map(|it| pages(it, &format!("{name}-{}", it.get_name())));
        [format!("{name}.1")].into_iter().chain(below).collect()
    }

    #[test]
    fn every_command_has_its_page() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path()).unwrap();
        let pages = pages(&Cli::command(), "relayrig");
        assert!(pages.contains(&"relayrig-history-backup.1".to_owned()));
        for page in pages {
            assert!(folder.path().join("man").join(&page).exists(), "{page}");
        }
    }

    #[test]
    fn every_shell_gets_all_commands() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path()).unwrap();
        for file in ["relayrig.bash", "_relayrig", "relayrig.fish"] {
            let text = fs::read_to_string(folder.path().join(file)).unwrap();
            for command in Cli::command().get_subcommands() {
                assert!(text.contains(command.get_name()), "{file}: {command}");
            }
        }
    }
}
