//! From [`AgentsFile`] to YAML that ROS 2 reads: doubles with a decimal point, integers without.

use std::fmt::Write as _;

use super::file::{AgentEntry, AgentsFile, BehaviorEntry, Configuration, Dialect, GoalEntry, Reaction};

impl AgentsFile {
    /// The file in its own dialect; reading it gives the same agents.
    #[must_use]
    pub fn to_yaml(&self) -> String {
        let mut out = String::from("hunav_loader:\n  ros__parameters:\n");
        match self.write(&mut out) {
            // Writing to a String cannot fail.
            Ok(()) | Err(std::fmt::Error) => out,
        }
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        if let Some(name) = &self.yaml_base_name {
            writeln!(out, "    yaml_base_name: {}", word(name))?;
        }
        if let Some(name) = &self.simulator {
            writeln!(out, "    simulator: {}", word(name))?;
        }
        writeln!(out, "    map: {}\n    publish_people: {}", word(&self.map), self.publish_people)?;
        if self.dialect == Dialect::V2_0 {
            writeln!(out, "    global_goals:")?;
            for (number, goal) in (1_usize..).zip(&self.global_goals) {
                writeln!(out, "      {number}:\n        x: {}\n        y: {}", real(goal.x), real(goal.y))?;
            }
        }
        writeln!(out, "    agents:")?;
        for agent in &self.agents {
            writeln!(out, "      - {}", word(&agent.name))?;
        }
        for agent in &self.agents {
            self.agent(agent, out)?;
        }
        Ok(())
    }

    fn agent(&self, agent: &AgentEntry, out: &mut String) -> std::fmt::Result {
        writeln!(out, "    {}:", word(&agent.name))?;
        writeln!(out, "      id: {}\n      skin: {}\n      group_id: {}", agent.id, agent.skin, agent.group_id)?;
        writeln!(out, "      max_vel: {}\n      radius: {}", real(agent.max_vel_mps), real(agent.radius_m))?;
        self.behavior(&agent.behavior, out)?;
        let start = &agent.start;
        writeln!(out, "      init_pose:\n        x: {}\n        y: {}", real(start.x), real(start.y))?;
        writeln!(out, "        z: {}\n        h: {}", real(start.z), real(start.h))?;
        writeln!(out, "      goal_radius: {}", real(agent.goal_radius_m))?;
        writeln!(out, "      cyclic_goals: {}\n      goals:", agent.cyclic_goals)?;
        for goal in &agent.goals {
            writeln!(
                out,
                "        - {}",
                if self.dialect == Dialect::V2_0 { goal.name.clone() } else { word(&goal.name) }
            )?;
        }
        if self.dialect != Dialect::V2_0 {
            let mut written: Vec<&str> = Vec::new();
            for goal in &agent.goals {
                if written.contains(&goal.name.as_str()) {
                    continue;
                }
                written.push(&goal.name);
                writeln!(out, "      {}:\n        x: {}", word(&goal.name), real(goal.at.x))?;
                writeln!(out, "        y: {}\n        h: {}", real(goal.at.y), real(goal.heading))?;
            }
        }
        Ok(())
    }

    fn behavior(&self, behavior: &BehaviorEntry, out: &mut String) -> std::fmt::Result {
        if self.dialect == Dialect::V1_0 {
            return writeln!(out, "      behavior: {}", behavior.reaction.code());
        }
        writeln!(out, "      behavior:")?;
        match self.dialect {
            Dialect::V2_0 => writeln!(out, "        type: {}", behavior.reaction.word())?,
            Dialect::V1_0 | Dialect::V1_1 => writeln!(out, "        type: {}", behavior.reaction.code())?,
        }
        writeln!(out, "        configuration: {}", behavior.configuration.code())?;
        if self.dialect == Dialect::V1_1 || has_reaction_keys(behavior) {
            writeln!(out, "        duration: {}\n        once: {}", real(behavior.duration_s), behavior.once)?;
            writeln!(out, "        vel: {}\n        dist: {}", real(behavior.vel_mps), real(behavior.dist_m))?;
        }
        writeln!(out, "        goal_force_factor: {}", real(behavior.goal_force_factor))?;
        writeln!(out, "        obstacle_force_factor: {}", real(behavior.obstacle_force_factor))?;
        writeln!(out, "        social_force_factor: {}", real(behavior.social_force_factor))?;
        writeln!(out, "        other_force_factor: {}", real(behavior.other_force_factor))
    }

    /// The same agents in another dialect, and a note for everything that it cannot say.
    #[must_use]
    pub fn converted(&self, to: Dialect) -> (Self, Vec<String>) {
        let mut file = Self { dialect: to, warnings: Vec::new(), ..self.clone() };
        let mut notes = Vec::new();
        if to == self.dialect {
            return (file, notes);
        }
        if to == Dialect::V2_0 {
            file.yaml_base_name.get_or_insert_with(|| "agents".to_owned());
            file.simulator.get_or_insert_with(|| "Gazebo".to_owned());
            number_goals(&mut file);
        } else {
            if let Some(base) = file.yaml_base_name.take() {
                notes.push(format!("{to} has no `yaml_base_name`: the trees {base}__agent_*_bt.xml are not named"));
            }
            if let Some(simulator) = file.simulator.take() {
                notes.push(format!("{to} has no `simulator`: `{simulator}` is left out"));
            }
            file.global_goals = Vec::new();
            if self.dialect == Dialect::V2_0 {
                for goal in file.agents.iter_mut().flat_map(|agent| &mut agent.goals) {
                    goal.name = format!("g{}", goal.name);
                }
            }
        }
        for agent in &mut file.agents {
            let behavior = &mut agent.behavior;
            if to != Dialect::V1_0
                && let Reaction::Custom(index) = behavior.reaction
            {
                notes.push(format!("{to} has no LLMBT_{index}: `{}` is regular", agent.name));
                behavior.reaction = Reaction::Regular;
            }
            let kept = match to {
                Dialect::V1_0 => BehaviorEntry { reaction: behavior.reaction, ..BehaviorEntry::default() },
                Dialect::V1_1 => *behavior,
                Dialect::V2_0 => {
                    let spare = BehaviorEntry::default();
                    BehaviorEntry {
                        duration_s: spare.duration_s,
                        once: spare.once,
                        vel_mps: spare.vel_mps,
                        dist_m: spare.dist_m,
                        ..*behavior
                    }
                }
            };
            if kept != *behavior && (to != Dialect::V1_0 || behavior.configuration != Configuration::Default) {
                notes.push(format!("{to} cannot say all parameters of the behavior of `{}`", agent.name));
            }
            *behavior = kept;
        }
        (file, notes)
    }
}

/// Whether parameters that 2.0 keeps in the tree file differ from their defaults.
fn has_reaction_keys(behavior: &BehaviorEntry) -> bool {
    let spare = BehaviorEntry::default();
    behavior.once != spare.once
        || [(behavior.duration_s, spare.duration_s), (behavior.vel_mps, spare.vel_mps), (behavior.dist_m, spare.dist_m)]
            .iter()
            .any(|(mine, other)| (mine - other).abs() > 0.0)
}

/// Gives the goals of all agents numbers; equal places share one.
fn number_goals(file: &mut AgentsFile) {
    let mut points = Vec::new();
    for goal in file.agents.iter_mut().flat_map(|agent| &mut agent.goals) {
        let place = match points.iter().position(|known| *known == goal.at) {
            Some(place) => place,
            None => {
                points.push(goal.at);
                points.len() - 1
            }
        };
        *goal = GoalEntry { name: (place + 1).to_string(), at: goal.at, heading: 0.0 };
    }
    file.global_goals = points;
}

/// A double as ROS 2 reads it: always with a decimal point.
fn real(value: f64) -> String {
    let text = format!("{value:?}");
    match text.split_once('e') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.0e{exponent}"),
        Some(_) | None => text,
    }
}

/// A text as YAML, in quotes where it could be taken for something else.
fn word(text: &str) -> String {
    let plain = text.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '/' | ' '))
        && text.trim() == text
        && !matches!(
            text.to_ascii_lowercase().as_str(),
            "true" | "false" | "yes" | "no" | "on" | "off" | "y" | "n" | "null" | "nan" | "inf"
        );
    if plain {
        return text.to_owned();
    }
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            c if c.is_control() => quoted.push_str(&format!("\\U{:08X}", u32::from(c))),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
