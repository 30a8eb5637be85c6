"""Exported tracks, read by the tools they are for, beside the table of the run.

Arguments: folder with a folder for each format, and the table (t, id, x, y) of the run. Prints an object: for each format how many
positions were compared and the largest distance, in meters.
"""

import csv, glob, json, math, pathlib, sqlite3, sys

import jupedsim, numpy, pedpy, shapely, trajnetplusplustools

folder, table = sys.argv[1:]
number = lambda name: 0 if name == "robot" else int(name.split("_")[1])
run = {}
for row in csv.DictReader(open(table)):
    if row["leaf"] != "absent":
        run[(round(float(row["t"]) * 100), number(row["id"]))] = (float(row["x"]), float(row["y"]))


def one(form, ending):
    (found,) = glob.glob(f"{folder}/{form}/*{ending}")
    return found


def compared(found, ticks):
    """The largest distance of what was found from the table, which has every tenth tick."""
    ticks = max(ticks, 10)
    wanted = {key for key in run if key[0] % ticks == 0}
    found = {key: at for key, at in found.items() if key[0] % ticks == 0}
    assert set(found) == wanted, (len(found), len(wanted), sorted(set(found) ^ wanted)[:5])
    return {"positions": len(found), "off": max(math.dist(at, run[key]) for key, at in found.items())}


def trajnet():
    reader = trajnetplusplustools.Reader(one("trajnet", ".ndjson"), scene_type="paths")
    scenes = list(reader.scenes())
    for _, paths in scenes:
        primary = paths[0]
        assert len(primary) == 21 and primary[0].pedestrian != 0, primary
    assert scenes, "no scene"
    found = {(row.frame * 40, row.pedestrian): (row.x, row.y) for rows in reader.tracks_by_frame.values() for row in rows}
    return compared(found, 40) | {"scenes": len(scenes)}


def eth_ucy():
    rows = numpy.loadtxt(one("eth-ucy", ".txt"), delimiter="\t")
    return compared({(int(frame) * 4, int(who)): (x, y) for frame, who, x, y in rows}, 40)


def of_frame(data):
    return {(int(row.frame), int(row.id)): (row.x, row.y) for row in data.itertuples()}


def text_of_pedpy():
    tracks = pedpy.load_trajectory_from_txt(trajectory_file=pathlib.Path(one("pedpy", ".txt")))
    assert tracks.frame_rate == 100.0
    assert set(numpy.unique(numpy.diff(numpy.unique(tracks.data.frame)))) == {1}
    area = pedpy.WalkableArea(open(one("pedpy", ".wkt")).read())
    pedpy.is_trajectory_valid(traj_data=tracks, walkable_area=area)
    speeds = pedpy.compute_individual_speed(traj_data=tracks, frame_step=10)
    return compared(of_frame(tracks.data), 1) | {
        "inside": bool(pedpy.is_trajectory_valid(traj_data=tracks, walkable_area=area)),
        "speed": float(speeds.speed.max()),
    }


def database():
    path = pathlib.Path(one("jupedsim-2", ".sqlite"))
    recording = jupedsim.Recording(str(path))
    found = {}
    for index in range(recording.num_frames):
        for agent in recording.frame(index).agents:
            found[(index, agent.id)] = agent.position
            assert abs(math.hypot(*agent.orientation) - 1) < 1e-5
    assert recording.fps == 100.0
    floor = shapely.from_wkt(open(one("pedpy", ".wkt")).read())
    assert shapely.equals(shapely.union_all(recording.geometry()), floor)
    tracks = pedpy.load_trajectory_from_jupedsim_sqlite(trajectory_file=path)
    assert of_frame(tracks.data).keys() == found.keys()
    area = pedpy.load_walkable_area_from_jupedsim_sqlite(trajectory_file=path)
    return compared(found, 1) | {"area": area.area}


print(json.dumps({"trajnet": trajnet(), "eth-ucy": eth_ucy(), "pedpy": text_of_pedpy(), "jupedsim-2": database()}))
