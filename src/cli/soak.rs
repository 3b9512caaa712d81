//! `covact soak`.
use super::{SoakArgs, exit, print, print_json, report};
use crate::soak::{Ending, Played, Settings, play};
use rayon::prelude::*;
use std::time::Duration;

pub(super) fn soak(args: &SoakArgs) -> u8 {
    let program = match super::program() {
        Ok(program) => program,
        Err(e) => {
            report::error(&format!("cannot tell where this program is: {e}"));
            return exit::IO;
        }
    };
    let settings = Settings {
        program,
        folder: args.out.clone(),
        limit: Duration::from_secs(args.limit),
        repeat: args.repeat,
    };
    let one = |seed: u64| {
        let played = play(seed, &settings)?;
        if !args.json {
            print(&line(&played));
        }
        Ok(played)
    };
    // A scene runs on one thread, so that as many run at once as there are cores.
    let seeds: Vec<u64> = (0..args.count).map(|i| args.seed.wrapping_add(i)).collect();
    let played: std::io::Result<Vec<Played>> =
        seeds.into_par_iter().with_max_len(1).map(one).collect();
    let played = match played {
        Ok(played) => played,
        Err(e) => {
            report::error(&format!("{}: {e}", args.out.display()));
            return exit::IO;
        }
    };
    if args.json {
        print_json(&played);
    }
    let count = |is: &dyn Fn(&Ending) -> bool| played.iter().filter(|p| is(&p.ending)).count();
    report::stderr(&format!(
        "{} scenes: {} reached their end, {} said why they did not, {} crashed, {} hung, {} lost something silently\n",
        played.len(),
        count(&|e| *e == Ending::Done),
        count(&|e| matches!(e, Ending::Told(_))),
        count(&|e| matches!(e, Ending::Crashed(_))),
        count(&|e| *e == Ending::Hung),
        count(&|e| matches!(e, Ending::Silent(_))),
    ));
    let repeated = || played.iter().filter_map(|p| Some((p, p.repeated?)));
    if args.repeat {
        let told = || repeated().filter(|(p, _)| p.warnings > 0);
        report::stderr(&format!(
            "{} were repeated, {} of them off by more than 2 % of their largest force; {} carry a warning, {} of these are off by \
             more than 1 %, {} where warnings about the mesh are held against elements of half the size, too\n",
            repeated().count(),
            repeated().filter(|(_, r)| r.off > 0.02).count(),
            told().count(),
            told().filter(|(_, r)| r.off > 0.01).count(),
            told().filter(|(_, r)| r.most() > 0.01).count(),
        ));
    }
    match played.iter().all(|p| p.ending.fair()) {
        true => 0,
        false => exit::NOT_CONVERGED,
    }
}

fn line(p: &Played) -> String {
    let why = match &p.ending {
        Ending::Told(why) | Ending::Crashed(why) | Ending::Silent(why) => {
            format!("\n        {why}")
        }
        Ending::Done | Ending::Hung => String::new(),
    };
    let off = (p.repeated).map_or(String::new(), |r| format!(" {:>6.2} % off", 100.0 * r.off));
    format!(
        "{:>7} {:<7} {:>5} steps {:>6} iterations {:>4} cuts {:>7.2} s{off}  {}{why}\n",
        p.seed,
        p.ending.name(),
        p.steps,
        p.iterations,
        p.cuts,
        p.seconds,
        p.story,
    )
}
