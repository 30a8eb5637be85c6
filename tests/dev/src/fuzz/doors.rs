//! The doors: everything that reads what a person or another program wrote.

use std::path::{Path, PathBuf};

use socrates_app::bundle::{self, Bundle};
use socrates_app::config::Config;
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::in_process::{self, Made};
use socrates_app::replay::tracks::{self, Known};
use socrates_app::{agents, bt, experiment, layout, map, prepare, prices};
use socrates_hunav::Inputs;
use socrates_llm::{Cassette, ChatAnswer, ChatRequest, Finish, Speaker, Turn};
use socrates_model::{AgentState, Location, Recording};
use socrates_offline::Draft;
use socrates_prompts::Question;
use socrates_stream::ros::Bag;

use super::mutate::{Chance, damaged};

/// An agents file of our own.
const AGENTS: &str = include_str!("agents.yaml");
/// A floor plan.
const PLAN: &str = include_str!("../../../../maps/office/plan.toml");
/// A table of prices.
const PRICES: &str = "[\"gpt-4o\"]\ninput = 2.5\ncached_input = 1.25\noutput = 10\ncurrency = \"USD\"\nvalid_from = \"2026-01\"\n\n[other]\ninput = 1\noutput = 2\n";
/// A bag of HuNavSim, neither compressed nor with checksums, and one that is compressed; both by a program of others.
const BAG: &[u8] = include_bytes!("../../../../bus/stream/tests/data/hunav.mcap");
const PACKED_BAG: &[u8] = include_bytes!("../../../../bus/stream/tests/data/walk.mcap");
/// What makes a folder a bag.
const METADATA: &str = "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  relative_file_paths:\n  - bag_0.mcap\n  \
                        compression_format: ''\n  compression_mode: ''\n  message_count: 105\n";
/// The folder of that bag.
const BAG_FOLDER: &str = "bag";
/// Sentences at a look of `--ask`.
const EDITS: &[&str] = &[
    "make the robot's path longer",
    "human_1 should wave at the robot for 3 s when it is within 2 m",
    "add a third person who follows human_2, then remove the first",
    "let human_1 and human_2 swap places; slow down the second one",
    "move the meeting to the elevator and make them a group",
];
/// Scenarios and agents are simulated for one accepted input in so many: a run takes longer than a reading.
const PLAYED: u64 = 8;
/// Length of a run of an agents file, s.
const AGENTS_SECS: f64 = 3.0;

/// One good input: the file that is damaged, beside whatever belongs to it.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    /// Name of the file within the folder.
    pub(super) file: String,
    /// What it holds.
    pub(super) bytes: Vec<u8>,
}

/// What every door needs: a whole bundle, and what comes of it.
pub(super) struct Kit {
    config: Config,
    /// The bundle's folder, and one for what is made on the way.
    folder: PathBuf,
    work: PathBuf,
    bundle: Bundle,
    location: Location,
}

/// Lets the bytes of an input in through a door.
type Open = fn(&Kit, &Path, &Sample, &[u8], &mut Chance) -> Result<(), Diagnostic>;

/// A door and its good inputs.
pub(super) struct Door {
    /// Its name, as `--door` takes it.
    pub(super) name: &'static str,
    /// Whether an error has to name the file: sentences have none.
    pub(super) names_file: bool,
    /// Its good inputs.
    pub(super) samples: fn(&Kit) -> Vec<Sample>,
    /// Lets an input in: the folder holds it under the sample's name.
    pub(super) open: Open,
}

/// Every door. A new reader is a line here.
pub(super) const DOORS: &[Door] = &[
    Door { name: "requests", names_file: true, samples: requests, open: open_request },
    Door { name: "trees", names_file: true, samples: trees, open: open_tree },
    Door { name: "agents", names_file: true, samples: agents_files, open: open_agents },
    Door { name: "maps", names_file: true, samples: maps, open: open_map },
    Door { name: "plans", names_file: true, samples: plans, open: open_plan },
    Door { name: "tables", names_file: true, samples: tables, open: open_tracks },
    Door { name: "recordings", names_file: true, samples: recordings, open: open_tracks },
    Door { name: "bags", names_file: true, samples: bags, open: open_bag },
    Door { name: "bundles", names_file: true, samples: bundle_files, open: open_bundle },
    Door { name: "config", names_file: true, samples: configs, open: open_config },
    Door { name: "prices", names_file: true, samples: prices, open: open_prices },
    Door { name: "experiments", names_file: true, samples: experiments, open: open_experiment },
    Door { name: "imports", names_file: true, samples: imports, open: open_import },
    Door { name: "cassettes", names_file: true, samples: cassettes, open: open_cassette },
    Door { name: "cards", names_file: false, samples: cards, open: open_card },
    Door { name: "edits", names_file: false, samples: edits, open: open_edit },
];

/// A door that answers wrongly in every way, to see that it is noticed; only where it is asked for by name.
pub(super) const ALARM: Door =
    Door { name: "alarm", names_file: true, samples: |_kit| vec![sample("alarm.txt", "fire")], open: open_alarm };

fn open_alarm(
    _kit: &Kit,
    _folder: &Path,
    _sample: &Sample,
    bytes: &[u8],
    chance: &mut Chance,
) -> Result<(), Diagnostic> {
    match chance.below(4) {
        0 => {
            let nothing: &[u8] = &[];
            // The very panic that a reader must not have.
            #[expect(clippy::indexing_slicing, reason = "this door panics on purpose")]
            let _out_of_range = nothing[bytes.len()];
            Ok(())
        }
        1 => {
            let (_kept, never) = std::sync::mpsc::sync_channel::<()>(1);
            Err(Diagnostic::input(format!("{:?}", never.recv()), ""))
        }
        2 => Err(Diagnostic::input("something is wrong somewhere", "")),
        _ => Err(Diagnostic::input("`alarm.txt` is wrong", "").with_code(Code::Ours)),
    }
}

impl Kit {
    /// The kit around a bundle that was made before.
    pub(super) fn of(config: &Config, folder: &Path, work: &Path) -> Result<Self, Diagnostic> {
        let bundle = bundle::read(folder)?;
        let (folder, work) = (folder.to_path_buf(), work.to_path_buf());
        Ok(Self { config: config.clone(), folder, work, location: bundle.location.clone(), bundle })
    }

    /// Puts into a folder what belongs to a door's inputs beside the damaged file.
    pub(super) fn furnish(&self, door: &Door, folder: &Path) -> std::io::Result<()> {
        for sample in (door.samples)(self) {
            let path = folder.join(&sample.file);
            if let Some(parent) = path.parent() {
                std::fs::create_dir_all(parent)?;
            }
            std::fs::write(path, sample.bytes)?;
        }
        // What is never damaged has to be there all the same.
        for name in self.bundle.manifest.files.keys().filter(|name| door.name == "bundles" && layout::in_details(name))
        {
            let path = folder.join(name);
            if let Some(parent) = path.parent() {
                std::fs::create_dir_all(parent)?;
            }
            if !path.exists() {
                std::fs::copy(self.folder.join(name), path)?;
            }
        }
        Ok(())
    }

    fn recording(&self) -> Option<&Recording> {
        self.bundle.runs.first().map(|(recording, _)| recording)
    }
}

/// The damaged form of a sample. Recordings are damaged once in two tries before they are written, so that their
/// checksums are right.
pub(super) fn damage(kit: &Kit, door: &Door, sample: &Sample, chance: &mut Chance) -> Vec<u8> {
    let is_recording = sample.file.ends_with(".mcap") && !Bag::begins(&sample.bytes);
    if is_recording
        && chance.below(2) == 0
        && let Some(bytes) = kit.recording().and_then(|recording| rewritten(recording, chance))
    {
        return bytes;
    }
    // Two thirds of the damage to a table is to its first lines, so that single cells are hit.
    let bytes = damaged(&sample.bytes, chance);
    if door.name == "tables" && chance.below(8) == 0 { bytes.get(..2000).unwrap_or(&bytes).to_vec() } else { bytes }
}

fn rewritten(recording: &Recording, chance: &mut Chance) -> Option<Vec<u8>> {
    let mut recording = recording.clone();
    for _ in 0..=chance.below(2) {
        let place = chance.place(recording.frames.len());
        let value = chance.float();
        let state: &mut AgentState = recording.frames.get_mut(place)?;
        match chance.below(10) {
            0 => state.x = value,
            1 => state.y = value,
            2 => state.yaw = value,
            3 => state.vx = value,
            4 => state.omega = value,
            5 => state.flags = u32::try_from(chance.below(u64::from(u32::MAX))).unwrap_or(0),
            6 => recording.header.step_s = value,
            7 => recording.header.agents.iter_mut().for_each(|info| info.radius_m = value),
            8 => {
                let at = chance.place(recording.events.len());
                let time = socrates_model::SimTime::from_nanos(value.to_bits());
                recording.events.get_mut(at).into_iter().for_each(|event| event.time = time);
            }
            _ => {
                let agents = recording.header.agents.len();
                recording.frames.truncate(place - place % agents.max(1));
            }
        }
    }
    socrates_stream::mcap::write(&recording, None).ok()
}

fn sample(file: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Sample {
    Sample { file: file.into(), bytes: bytes.into() }
}

fn requests(kit: &Kit) -> Vec<Sample> {
    let shipped = socrates_maps::shipped::names().iter().flat_map(|name| socrates_maps::shipped::requests(name));
    let shipped = shipped.map(|(stem, text)| sample(format!("{stem}.toml"), text));
    shipped
        .chain([sample(
            "full.toml",
            include_str!("../../../../orchestrator/app/src/request.toml").replace("LOCATION", "office"),
        )])
        .chain(read_sample(kit, "request.toml"))
        .collect()
}

fn open_request(
    kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    chance: &mut Chance,
) -> Result<(), Diagnostic> {
    let prepared = prepare::prepare(&folder.join(&sample.file), None, &kit.config)?;
    if chance.below(PLAYED) > 0 {
        return Ok(());
    }
    let runtime = tokio::runtime::Builder::new_current_thread()
        .build()
        .map_err(|why| Diagnostic::input(why.to_string(), "").with_code(Code::Ours))?;
    // Faults of a scenario are an answer of the authors and name the scenario.
    drop(runtime.block_on(in_process::play(&prepared.request, &prepared.location, 1)));
    Ok(())
}

fn trees(kit: &Kit) -> Vec<Sample> {
    kit.bundle.behaviors.humans.iter().map(|(id, human)| sample(format!("{id}.xml"), human.tree.as_bytes())).collect()
}

fn open_tree(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    let (tree, library) = bt::load(&folder.join(&sample.file), None)?;
    drop((socrates_bt::draw_text(&tree), socrates_bt::analyze(&tree)));
    drop(socrates_bt::convert(&tree, socrates_bt::Format::V3, library));
    Ok(())
}

fn agents_files(_kit: &Kit) -> Vec<Sample> {
    vec![sample("agents.yaml", AGENTS)]
}

fn open_agents(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    chance: &mut Chance,
) -> Result<(), Diagnostic> {
    let (file, agents) = agents::read(&folder.join(&sample.file))?;
    let mut inputs = Inputs::new(&agents, &file);
    inputs.duration_s = AGENTS_SECS;
    if chance.below(PLAYED) == 0 {
        socrates_hunav::simulate(&inputs).map_err(|problems| agents::listed(&file, &problems))?;
    }
    Ok(())
}

fn maps(_kit: &Kit) -> Vec<Sample> {
    let files = socrates_maps::shipped::files("hospital").unwrap_or_default();
    files.into_iter().filter(|(name, _)| name != "plan.toml").map(|(name, bytes)| sample(name, bytes)).collect()
}

fn open_map(
    _kit: &Kit,
    folder: &Path,
    _sample: &Sample,
    _bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    let (location, _) = prepare::load_location(&folder.display().to_string(), folder)?;
    drop(socrates_draw::annotated_map(&location));
    Ok(())
}

fn plans(_kit: &Kit) -> Vec<Sample> {
    vec![sample("plan.toml", PLAN)]
}

fn open_plan(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    map::generated(&folder.join(&sample.file)).map(drop)
}

fn tables(kit: &Kit) -> Vec<Sample> {
    kit.recording()
        .map(|recording| sample("tracks.csv", socrates_stream::csv::write_agents(&[recording])))
        .into_iter()
        .collect()
}

fn recordings(kit: &Kit) -> Vec<Sample> {
    let names = kit.bundle.manifest.runs.iter().map(|entry| layout::RECORDINGS.of(&entry.run()));
    let mut found: Vec<Sample> = names.filter_map(|name| read_sample(kit, &name)).collect();
    found.iter_mut().for_each(|sample| sample.file = "recording.mcap".to_owned());
    found.truncate(1);
    found
}

fn open_tracks(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    tracks::score(&folder.join(&sample.file).display().to_string(), bytes, &Known::default()).map(drop)
}

fn bags(_kit: &Kit) -> Vec<Sample> {
    vec![
        sample(format!("{BAG_FOLDER}/metadata.yaml"), METADATA),
        sample(format!("{BAG_FOLDER}/bag_0.mcap"), BAG),
        sample("packed.mcap", PACKED_BAG),
    ]
}

fn open_bag(_kit: &Kit, folder: &Path, sample: &Sample, _bytes: &[u8], _chance: &mut Chance) -> Result<(), Diagnostic> {
    let is_inside = Path::new(&sample.file).starts_with(BAG_FOLDER);
    let path = folder.join(if is_inside { BAG_FOLDER } else { sample.file.as_str() });
    tracks::at(&path, &Known::default()).map(drop)
}

/// One file of the bundle.
fn read_sample(kit: &Kit, name: &str) -> Option<Sample> {
    Some(sample(name, std::fs::read(kit.folder.join(name)).ok()?))
}

fn bundle_files(kit: &Kit) -> Vec<Sample> {
    let parts =
        [layout::MANIFEST, layout::LOCATION, layout::READING, layout::PROPOSAL, layout::PATHS, layout::BEHAVIORS];
    let parts = parts.iter().map(|sheet| sheet.path.to_owned());
    let runs = kit.bundle.manifest.runs.iter().map(bundle::RunEntry::run);
    let runs = runs.flat_map(|run| [layout::RECORDINGS.of(&run), layout::REPORTS.of(&run)]);
    parts.chain(runs).chain([layout::REQUEST.path.to_owned()]).filter_map(|name| read_sample(kit, &name)).collect()
}

fn open_bundle(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    chance: &mut Chance,
) -> Result<(), Diagnostic> {
    let bundle = bundle::read(folder)?;
    let made =
        Made { proposal: bundle.proposal.clone(), paths: bundle.paths.clone(), behaviors: bundle.behaviors.clone() };
    for (recording, _) in &bundle.runs {
        let evidence = in_process::evidence(&bundle.request, &bundle.reading, &bundle.location, &made, recording);
        drop(socrates_scoring::score(&evidence));
    }
    if let Some(entry) = bundle.manifest.runs.first().filter(|_| chance.below(PLAYED) == 0) {
        // What cannot be simulated is refused with the fault; here only panics and hangs count.
        drop(socrates_app::replay::written(&bundle, &entry.run(), None));
    }
    // The digests stand in the manifest: with it damaged any file may seem changed.
    let is_manifest = sample.file == layout::MANIFEST.path;
    if is_manifest || bundle::changed(&bundle).iter().all(|name| *name == sample.file) {
        return Ok(());
    }
    Err(Diagnostic::input("a file that was not damaged counts as changed", ""))
}

fn configs(_kit: &Kit) -> Vec<Sample> {
    vec![sample("socrates.toml", socrates_app::config::BUILT_IN)]
}

fn open_config(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    Config::load(Some(&folder.join(&sample.file)), std::iter::empty(), &[]).map(|config| drop(config.lines(None)))
}

fn prices(_kit: &Kit) -> Vec<Sample> {
    vec![sample("prices.toml", PRICES)]
}

fn open_prices(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    prices::read_prices(&folder.join(&sample.file)).map(drop)
}

fn experiments(_kit: &Kit) -> Vec<Sample> {
    let shipped = experiment::DOOR.shipped.iter();
    shipped.map(|(name, text)| sample(format!("{name}.toml"), *text)).collect()
}

fn open_experiment(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    experiment::load(&folder.join(&sample.file), None).map(drop)
}

fn imports(kit: &Kit) -> Vec<Sample> {
    let Bundle { proposal, paths, behaviors, .. } = &kit.bundle;
    let combined = socrates_export::socrates_json::combined(proposal, paths, behaviors);
    vec![sample("combined.json", serde_json::to_vec_pretty(&combined).unwrap_or_default())]
}

fn open_import(
    _kit: &Kit,
    folder: &Path,
    sample: &Sample,
    _bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    socrates_app::dev::imported(&folder.join(&sample.file)).map(drop)
}

fn asked() -> ChatRequest {
    let turns = vec![Turn { speaker: Speaker::User, text: "How many people?".to_owned(), png: None }];
    let form = "answer".to_owned();
    ChatRequest {
        turns,
        form,
        schema: None,
        grammar: None,
        seed: None,
        temperature: None,
        max_tokens: 100,
        detail: socrates_llm::Detail::default(),
    }
}

fn cassettes(kit: &Kit) -> Vec<Sample> {
    let answer = ChatAnswer {
        text: "{\"people\": 2}".to_owned(),
        finish: Finish::Stop,
        model: "model-1".to_owned(),
        tokens: (12, 7),
        cached: 0,
        thought: 0,
        estimated: false,
        rung: None,
        steps: Vec::new(),
        without_picture: false,
        limits: None,
    };
    // Kept and read back, so that the sample has the form that this version writes.
    let folder = kit.work.join("cassette");
    let key = Cassette::key(&asked());
    if Cassette::at(&folder).keep(&asked(), &answer, None).is_err() {
        return Vec::new();
    }
    let file = format!("{}/{key}.json", key.get(..2).unwrap_or_default());
    std::fs::read(folder.join(&file)).map(|bytes| sample(file, bytes)).into_iter().collect()
}

fn open_cassette(
    _kit: &Kit,
    folder: &Path,
    _sample: &Sample,
    _bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    Cassette::at(folder).find(&asked()).map(drop).map_err(|why| Diagnostic::input(why.to_string(), ""))
}

fn cards(_kit: &Kit) -> Vec<Sample> {
    let card = include_str!("../../../../prompts/catalog/frontal_approach.toml");
    let group = include_str!("../../../../prompts/catalog/join_group.toml");
    vec![sample("frontal_approach.toml", card), sample("join_group.toml", group)]
}

fn open_card(
    _kit: &Kit,
    _folder: &Path,
    _sample: &Sample,
    bytes: &[u8],
    _chance: &mut Chance,
) -> Result<(), Diagnostic> {
    let text = String::from_utf8_lossy(bytes);
    toml::from_str::<socrates_offline::Card>(&text).map(drop).map_err(|why| Diagnostic::input(why.to_string(), ""))
}

fn edits(_kit: &Kit) -> Vec<Sample> {
    EDITS.iter().map(|words| sample("words", *words)).collect()
}

fn open_edit(kit: &Kit, _folder: &Path, _sample: &Sample, bytes: &[u8], chance: &mut Chance) -> Result<(), Diagnostic> {
    let bundle = &kit.bundle;
    let question = Question::first(bundle.request.clone(), bundle.reading.clone(), kit.location.clone(), 1);
    let draft = Draft {
        proposal: bundle.proposal.clone(),
        paths: Some(bundle.paths.clone()),
        behaviors: Some(bundle.behaviors.clone()),
    };
    let mut words = String::from_utf8_lossy(bytes).into_owned();
    // A line that nobody types is no input.
    if let Some((end, _)) = words.char_indices().nth(4000) {
        words.truncate(end);
    }
    let edited = socrates_offline::edit(&question, &draft, &words);
    if chance.below(PLAYED) == 0 {
        drop(socrates_offline::edit(&question, &edited.draft, EDITS.first().copied().unwrap_or_default()));
    }
    Ok(())
}
