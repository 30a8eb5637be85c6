//! Anybody's ids made ours: `ped1` and `base_link` as well as `human_1` and `robot`.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::AgentId;

use super::{Table, bad};
use crate::error::StreamError;

/// So many ids are named in a message.
const NAMED: usize = 8;

/// How the ids of a table became ours.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Named {
    /// What the file calls those who got another name.
    pub names: BTreeMap<AgentId, String>,
    /// Everybody, by the id of the file.
    pub agents: BTreeMap<String, AgentId>,
}

impl Named {
    /// The agent that the file, or the user, calls so.
    #[must_use]
    pub fn agent(&self, id: &str) -> Option<AgentId> {
        let id = id.trim();
        self.agents.get(id).copied().or_else(|| ours(id).filter(|agent| self.agents.values().any(|have| have == agent)))
    }
}

/// Gives everybody of a table an id of ours. The robot is `robot` or 0, or who is named here; `human_3` and 3 keep their number.
/// All others are people. They get the number at the end of their id where no two would get the same, else free numbers in
/// order of their ids.
///
/// # Errors
/// [`StreamError::Csv`] where the robot that is named is not in the table.
pub fn named(table: &mut Table, robot: Option<&str>) -> Result<Named, StreamError> {
    let Some(at) = table.column("id") else { return Ok(Named::default()) };
    let ids = table.rows.iter().filter_map(|row| row.cells.get(at)).filter(|id| !id.is_empty());
    let agents = agents(&ids.cloned().collect(), robot).map_err(|why| bad(table.head.line, &why))?;
    for id in table.rows.iter_mut().filter_map(|row| row.cells.get_mut(at)) {
        if let Some(agent) = agents.get(id.as_str()).filter(|agent| readable(id) != Some(**agent)) {
            *id = agent.to_string();
        }
    }
    let renamed = agents.iter().filter(|(id, agent)| ours(id) != Some(**agent));
    let names: BTreeMap<AgentId, String> = renamed.map(|(id, agent)| (*agent, id.clone())).collect();
    Ok(Named { names, agents })
}

/// The agent of an id that is ours: `robot`, `human_3`, `3`, and `3.0` as spreadsheets write it.
fn ours(id: &str) -> Option<AgentId> {
    readable(id).or_else(|| id.strip_suffix(".0").and_then(readable))
}

/// The same as tracks are read, letter by letter.
fn readable(id: &str) -> Option<AgentId> {
    id.parse::<u32>().map(AgentId::from_number).ok().or_else(|| id.parse().ok())
}

/// Who is whom.
fn agents(ids: &BTreeSet<String>, robot: Option<&str>) -> Result<BTreeMap<String, AgentId>, String> {
    if let Some(robot) = robot.filter(|robot| !ids.contains(*robot)) {
        let have: Vec<String> = ids.iter().take(NAMED).map(|id| format!("`{id}`")).collect();
        let more = if ids.len() > NAMED { format!(" and {} more", ids.len() - NAMED) } else { String::new() };
        return Err(format!("there is no `{robot}` to be the robot; the ids are {}{more}", have.join(", ")));
    }
    let known = |id: &String| match robot {
        Some(robot) if robot == id => Some(AgentId::Robot),
        // Where the robot has another name, `robot` and 0 are people.
        Some(_) => ours(id).filter(|agent| *agent != AgentId::Robot),
        None => ours(id),
    };
    let mut agents: BTreeMap<String, AgentId> =
        ids.iter().filter_map(|id| known(id).map(|agent| (id.clone(), agent))).collect();
    let mut taken: BTreeSet<u32> = agents.values().map(|agent| agent.number()).collect();
    // In the order in which people count: `ped2` before `ped10`.
    let mut others: Vec<(&String, Option<u32>)> =
        ids.iter().filter(|id| !agents.contains_key(*id)).map(|id| (id, ending(id))).collect();
    others.sort_by(|a, b| counted(a).cmp(&counted(b)));
    let endings: BTreeSet<u32> = others.iter().filter_map(|(_, number)| *number).collect();
    let apart = endings.len() == others.len() && endings.iter().all(|number| *number > 0 && !taken.contains(number));
    let mut next = 1;
    for (id, number) in others {
        while taken.contains(&next) {
            next += 1;
        }
        let number = number.filter(|_| apart).unwrap_or(next);
        taken.insert(number);
        agents.insert(id.clone(), AgentId::from_number(number));
    }
    Ok(agents)
}

/// What ids are ordered by: their beginning, then the number at their end.
fn counted<'a>((id, number): &(&'a String, Option<u32>)) -> (&'a str, Option<u32>, &'a str) {
    (id.trim_end_matches(|c: char| c.is_ascii_digit()), *number, id)
}

/// The number at the end of an id.
fn ending(id: &str) -> Option<u32> {
    let digits = id.len() - id.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    id.get(id.len() - digits..)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::read_table;

    fn table(ids: &[&str]) -> Table {
        let lines = ids.iter().flat_map(|id| [format!("0,{id},1,2"), format!("1,{id},2,2")]);
        let text = std::iter::once("t,id,x,y".to_owned()).chain(lines).collect::<Vec<_>>();
        Table::read(&text.join("\n")).unwrap()
    }

    fn who(ids: &[&str], robot: Option<&str>) -> Vec<String> {
        let mut table = table(ids);
        let found = named(&mut table, robot).unwrap();
        assert!(read_table(&table).is_ok(), "{table:?}");
        ids.iter().map(|id| found.agent(id).unwrap().to_string()).collect()
    }

    #[test]
    fn ids_of_trackers_become_ours_and_the_robot_is_whom_the_user_names() {
        assert_eq!(who(&["base_link", "ped1", "ped12"], Some("base_link")), ["robot", "human_1", "human_12"]);
        assert_eq!(who(&["ped0", "ped1", "ped10"], None), ["human_1", "human_2", "human_3"]);
        assert_eq!(who(&["a/b-1", "c 1", "\u{4e2d}"], None), ["human_1", "human_2", "human_3"]);
        assert_eq!(who(&["robot", "human_2", "visitor"], None), ["robot", "human_2", "human_1"]);
        assert_eq!(who(&["0", "2", "7.0"], None), ["robot", "human_2", "human_7"]);
        assert_eq!(who(&["0", "robot", "me"], Some("me")), ["human_1", "human_2", "robot"]);
    }

    #[test]
    fn ids_that_are_ours_stay_as_they_are() {
        let before = table(&["robot", "human_1", "3"]);
        let mut after = before.clone();
        let found = named(&mut after, None).unwrap();
        assert_eq!((after, found.names.len()), (before, 0));
    }

    #[test]
    fn a_robot_that_is_not_there_is_told_with_those_who_are() {
        let why = named(&mut table(&["ped1", "odom"]), Some("base_link")).unwrap_err().to_string();
        assert!(why.contains("no `base_link`") && why.contains("`odom`, `ped1`"), "{why}");
    }

    #[test]
    fn a_name_with_a_comma_stays_one_cell() {
        let mut table = Table::read("t,id,x,y\n0,\"Ann, 7\",1,2\n1,\"Ann, 7\",2,2\n").unwrap();
        let found = named(&mut table, None).unwrap();
        assert_eq!(found.names[&AgentId::from_number(7)], "Ann, 7");
        assert!(read_table(&table).is_ok());
    }
}
