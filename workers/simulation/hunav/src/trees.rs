//! The trees of agents: the caller's files by name, else the default tree of the reaction, written from its
//! description.

use std::collections::BTreeMap;

use socrates_bt::{Library, Meaning, Options, Tree};

use crate::agents::{AgentEntry, AgentsFile, Dialect, Reaction};
use crate::configure::Parameters;
use crate::problem::Problem;
use crate::profile::Profile;

/// Finds a tree file by its name, such as `LLMBT_0.xml`; `None` where there is none.
pub type TreeFiles<'a> = &'a dyn Fn(&str) -> Option<String>;

/// Name of the file that HuNavSim keeps the tree of a reaction in.
#[must_use]
pub fn default_tree_file(reaction: Reaction) -> String {
    match reaction {
        Reaction::Regular | Reaction::Impassive => "BTRegularNav.xml".to_owned(),
        Reaction::Surprised => "BTSurprisedNav.xml".to_owned(),
        Reaction::Scared => "BTScaredNav.xml".to_owned(),
        Reaction::Curious => "BTCuriousNav.xml".to_owned(),
        Reaction::Threatening => "BTThreateningNav.xml".to_owned(),
        Reaction::Custom(index) => format!("LLMBT_{index}.xml"),
    }
}

/// The default tree of a reaction as a library has it; `None` where it has none that could be loaded.
#[must_use]
pub fn default_tree(reaction: Reaction, library: Library) -> Option<String> {
    let once_1_0 = if reaction == Reaction::Scared { "False" } else { "True" };
    // Distance, seconds, only once; the ports of the action beyond its agent and step.
    let plain = |seconds: &str, distance: &str| (distance.to_owned(), seconds.to_owned(), once_1_0.to_owned());
    let by_entry = |distance: &str| (distance.to_owned(), "{duration}".to_owned(), "{once}".to_owned());
    let tag = match reaction {
        Reaction::Regular | Reaction::Impassive => return Some(regular(library)),
        Reaction::Surprised => "SurprisedNav",
        Reaction::Scared => "ScaredNav",
        Reaction::Curious => "CuriousNav",
        Reaction::Threatening => "ThreateningNav",
        Reaction::Custom(_) => return None,
    };
    let (seen, action) = match (library, reaction) {
        (Library::HunavSim1_0, Reaction::Surprised) => (plain("30.0", "4.0"), ""),
        (Library::HunavSim1_0, Reaction::Scared) => (plain("40.0", "3.0"), ""),
        (Library::HunavSim1_0, Reaction::Curious) => (plain("30.0", "10.0"), ""),
        (Library::HunavSim1_0, _) => (plain("40.0", "4.0"), ""),
        (Library::HunavSim1_1 | Library::HunavSim2, Reaction::Surprised) => (by_entry("{dist}"), ""),
        (Library::HunavSim1_1 | Library::HunavSim2, Reaction::Scared) => {
            (by_entry("{dist}"), " runaway_vel=\"{maxvel}\" scary_force_factor=\"{forcefactor}\"")
        }
        (Library::HunavSim1_1 | Library::HunavSim2, Reaction::Curious) => {
            (by_entry("10.0"), " stop_distance=\"{stopdist}\" agent_vel=\"{maxvel}\"")
        }
        (Library::HunavSim1_1 | Library::HunavSim2, _) => (by_entry("4.5"), " goal_dist=\"{frontdist}\""),
        (Library::SocratesFork, Reaction::Curious) => (plain("30.0", "10.0"), ""),
        // The fork's own files name nodes that it no longer has.
        (Library::SocratesFork | Library::Native | Library::BuiltIn, _) => return None,
    };
    let tag = if library == Library::SocratesFork { "FollowRobot" } else { tag };
    Some(reacting(library, tag, action, &seen))
}

const REGULAR_BODY: &str = r#"  <BehaviorTree ID="RegularNavTree">
    <Fallback name="RegularNavFallback">
      <Sequence name="RegularNavigation">
        <Inverter>
          <IsGoalReached agent_id="{id}"/>
        </Inverter>
        <RegularNav agent_id="{id}" time_step="{dt}"/>
      </Sequence>
      <UpdateGoal agent_id="{id}"/>
    </Fallback>
  </BehaviorTree>
"#;

fn root(library: Library, main: &str) -> String {
    let format = if library == Library::HunavSim2 { " BTCPP_format=\"4\"" } else { "" };
    format!("<root main_tree_to_execute=\"{main}\"{format}>\n")
}

fn regular(library: Library) -> String {
    format!("{}{REGULAR_BODY}</root>\n", root(library, "RegularNavTree"))
}

/// Reacts while the robot is seen and the time is not over, walks on otherwise.
fn reacting(library: Library, tag: &str, ports: &str, (distance, seconds, once): &(String, String, String)) -> String {
    let subtree = if library == Library::HunavSim2 {
        "id=\"{agentid}\" dt=\"{timestep}\""
    } else {
        "id=\"agentid\" dt=\"timestep\""
    };
    let root = root(library, "ReactionTree");
    format!(
        r#"{root}  <include path="BTRegularNav.xml"/>
  <BehaviorTree ID="ReactionTree">
    <Fallback name="ReactOrWalk">
      <Sequence name="React">
        <IsRobotVisible agent_id="{{id}}" distance="{distance}"/>
        <Inverter>
          <TimeExpiredCondition seconds="{seconds}" ts="{{dt}}" only_once="{once}"/>
        </Inverter>
        <{tag} agent_id="{{id}}" time_step="{{dt}}"{ports}/>
      </Sequence>
      <Sequence name="Walk">
        <SetBlackboard output_key="agentid" value="{{id}}"/>
        <SetBlackboard output_key="timestep" value="{{dt}}"/>
        <SubTree ID="RegularNavTree" {subtree}/>
      </Sequence>
    </Fallback>
  </BehaviorTree>
</root>
"#
    )
}

/// The tree of one agent with the blackboard it starts with.
#[derive(Debug, Clone)]
pub(crate) struct OwnTree {
    pub(crate) tree: Tree,
    pub(crate) entries: BTreeMap<String, String>,
    /// Whether the tree puts goals on the list itself; then it starts with none.
    pub(crate) sets_goals: bool,
}

/// Nodes that move several agents at once; nobody here does.
const JOINT: [&str; 2] = ["ConversationFormation", "SetGroupWalk"];

/// Which library a tree of this file is read with in this profile.
///
/// Ours takes the trees of every library; the file's dialect tells which one was meant.
fn library_of(profile: Profile, file: &AgentsFile, reaction: Reaction) -> Library {
    match (profile, file.dialect, reaction) {
        (Profile::Native, _, Reaction::Custom(_)) => Library::Native,
        (Profile::Native, Dialect::V2_0, _) => Library::HunavSim2,
        // The reactions of 1.1 are those of 1.0 with their numbers as parameters.
        (Profile::Native, Dialect::V1_0 | Dialect::V1_1, _) => Library::HunavSim1_1,
        (Profile::SocratesFork | Profile::Hunav10 | Profile::Hunav11 | Profile::Hunav20, _, _) => profile.library(),
    }
}

/// Reads the tree of an agent.
pub(crate) fn tree_of(
    file: &AgentsFile,
    name: &str,
    agent: &AgentEntry,
    profile: Profile,
    parameters: &Parameters,
    files: TreeFiles<'_>,
) -> Result<OwnTree, Vec<Problem>> {
    let reaction = agent.behavior.reaction;
    let place = format!("{}.behavior", agent.name);
    let library = library_of(profile, file, reaction);
    if let Reaction::Custom(index) = reaction
        && !matches!(profile, Profile::Native | Profile::SocratesFork)
    {
        let message = format!("{profile} has no trees LLMBT_{index}");
        return Err(vec![
            Problem::error(name, place, message)
                .with_value(reaction.code())
                .with_hint("codes 7 to 16 are for native and socrates-fork"),
        ]);
    }
    let named = file.tree_file(agent);
    let (tree_name, text, library) = match named.as_ref().and_then(|named| Some((named.clone(), files(named)?))) {
        Some((named, text)) => (named, text, library),
        None => {
            let default = default_tree_file(reaction);
            let given = if matches!(reaction, Reaction::Custom(_)) { None } else { files(&default) };
            match given {
                // A file beside the agents is meant in the spelling that its nodes have.
                Some(text) => {
                    let library = spelled(&text, library, profile, files);
                    (default, text, library)
                }
                None => match default_tree(reaction, library) {
                    Some(text) => (default, text, library),
                    None => return Err(vec![no_tree(name, &place, agent, profile, named.as_deref())]),
                },
            }
        }
    };
    let tree = read(&text, library, files).map_err(|faults| {
        faults
            .iter()
            .map(|fault| {
                let message = format!("the tree `{tree_name}` cannot be run in {profile}: {fault}");
                Problem::error(name, &place, message).with_value(reaction.code())
            })
            .collect::<Vec<Problem>>()
    })?;
    let written = tree.to_xml(tree.format());
    let uses = |tag: &str| written.contains(&format!("<{tag} "));
    if let Some(tag) = JOINT.iter().find(|tag| uses(tag)) {
        let message = format!("the tree `{tree_name}` uses `{tag}`, which moves several agents at once");
        let hint = "give each agent a tree of its own with GoTo, FollowAgent or LookAtAgent";
        return Err(vec![Problem::error(name, &place, message).with_hint(hint)]);
    }
    Ok(OwnTree { sets_goals: uses("SetGoal"), tree, entries: entries(agent, parameters) })
}

fn read(text: &str, library: Library, files: TreeFiles<'_>) -> Result<Tree, Vec<socrates_model::Fault>> {
    // A regular tree of ours stands in for a missing include, in the version of the document.
    let v4 = text.contains("BTCPP_format=\"4\"") || text.contains("BTCPP_format='4'");
    let includes = |path: &str| {
        let base = path.rsplit(['/', '\\']).next().unwrap_or(path);
        files(path)
            .or_else(|| files(base))
            .or_else(|| (base == "BTRegularNav.xml").then(|| regular(if v4 { Library::HunavSim2 } else { library })))
    };
    let options = Options { includes: Some(&includes), library, meaning: Meaning::World, ..Options::default() };
    Tree::parse_with(text, &options)
}

/// Ours reads a tree with the first of the libraries that knows all its nodes.
fn spelled(text: &str, first: Library, profile: Profile, files: TreeFiles<'_>) -> Library {
    if profile != Profile::Native {
        return first;
    }
    let libraries =
        [first, Library::HunavSim1_1, Library::HunavSim1_0, Library::HunavSim2, Library::SocratesFork, Library::Native];
    libraries.into_iter().find(|library| read(text, *library, files).is_ok()).unwrap_or(first)
}

fn no_tree(name: &str, place: &str, agent: &AgentEntry, profile: Profile, named: Option<&str>) -> Problem {
    let reaction = agent.behavior.reaction;
    match named {
        Some(file) => Problem::error(name, place, format!("the tree `{file}` is not there"))
            .with_value(reaction.code())
            .with_hint("put it beside the agents file, or choose a behavior from 1 to 6"),
        None => {
            let message =
                format!("{profile} has no tree for `{}`: its file names nodes that it does not have", reaction.word());
            Problem::error(name, place, message)
                .with_value(reaction.code())
                .with_hint("choose 1 regular, 2 impassive or 5 curious, or another profile")
        }
    }
}

/// The blackboard of an agent.
fn entries(agent: &AgentEntry, parameters: &Parameters) -> BTreeMap<String, String> {
    let real = |value: f64| format!("{value:?}");
    [
        ("id", agent.id.to_string()),
        ("dt", real(socrates_model::time::STEP_SECS)),
        ("duration", real(parameters.duration_s)),
        ("once", parameters.once.to_string()),
        ("dist", real(parameters.dist_m)),
        ("stopdist", real(parameters.dist_m)),
        ("frontdist", real(parameters.dist_m)),
        ("maxvel", real(parameters.vel_mps)),
        ("forcefactor", real(parameters.other_force)),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}
