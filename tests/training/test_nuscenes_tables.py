"""Tests reading nuScenes' tables and the errors for invalid ones."""

import tempfile
import unittest
from pathlib import Path
from unittest import mock

from tests.training.nuscenes_tree import VERSION, edit_table, write_tree
from training.nuscenes import json_records
from training.nuscenes.errors import (
    MissingFileError,
    MissingFrameError,
    MissingSceneError,
    MissingTokenError,
    UnreadableJsonError,
    WrongTypeError,
)
from training.nuscenes.json_records import Record, read_array
from training.nuscenes.tables import (
    CAMERA_CHANNELS,
    find_version,
    load_tables,
    read_scene_names,
)


class Arrays(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "table.json"

    def read(self, text: str) -> list[dict]:
        self.path.write_text(text)
        return [record.values for record in read_array(self.path)]

    def test_the_chunk_size_does_not_matter(self):
        text = '[\n{"a": "x,]}"},\n {"a": [1, {"b": 2.5}]} ,{}\n]\n'
        expected = [{"a": "x,]}"}, {"a": [1, {"b": 2.5}]}, {}]
        for chunk in (1, 2, 3, 7, 2**20):
            with mock.patch.object(json_records, "_CHUNK_CHARACTERS", chunk):
                self.assertEqual(self.read(text), expected)
        self.assertEqual(self.read("[]"), [])

    def test_invalid_json_is_refused_with_its_place(self):
        for text, place in (
            ("", "line 1, column 1:"),
            ('{"a": 1}', "line 1, column 1:"),
            ('[{"a": 1},\n {"a": oops}]', "line 2, column 8:"),
            ('[{"a": 1}\n {"a": 2}]', "line 2, column 2:"),
            ('[{"a": 1},\n\n{"a": "cut', "line 3, column 7:"),
            ('[{"a": 1}', "line 1, column 10:"),
            ("[]\n[]", "line 2, column 1:"),
        ):
            for chunk in (1, 2**20):
                with mock.patch.object(json_records, "_CHUNK_CHARACTERS", chunk):
                    with self.assertRaisesRegex(UnreadableJsonError, f"table.json: {place}"):
                        self.read(text)

    def test_invalid_utf8_is_refused(self):
        self.path.write_bytes(b'[{"a": "\xff"}]')
        with self.assertRaisesRegex(UnreadableJsonError, "table.json: invalid UTF-8"):
            list(read_array(self.path))

    def test_a_record_that_is_not_an_object_is_refused(self):
        with self.assertRaisesRegex(WrongTypeError, "record 1: found 5, wanted an object"):
            self.read("[{}, 5]")


class Fields(unittest.TestCase):
    def test_a_value_of_another_type_is_refused(self):
        values = {
            "text": 3,
            "whole": True,
            "number": "1",
            "vector": [1, 2],
            "quaternion": [1, 1, 0, 0],
            "matrix": [[1, 2, 3]],
            "flag": 0,
        }
        record = Record(values, "place")
        for read, wanted in (
            (lambda: record.text("text"), "place: 'text' is 3, wanted a text"),
            (lambda: record.whole("whole"), "'whole' is true, wanted a whole number"),
            (lambda: record.number("number"), "'number' is \"1\", wanted a number"),
            (lambda: record.numbers("vector", 3), r"'vector' is \[1, 2\], wanted 3 numbers"),
            (lambda: record.unit_quaternion("quaternion"), r"wanted a unit .*norm is 1.4142"),
            (lambda: record.matrix3("matrix"), "wanted 3 rows of 3 numbers"),
            (lambda: record.flag("flag"), "'flag' is 0, wanted true or false"),
            (lambda: record.text("absent"), "place: found no 'absent', wanted a text"),
        ):
            with self.assertRaisesRegex(WrongTypeError, wanted):
                read()


class Tree(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        write_tree(self.root)
        self.folder = self.root / VERSION

    def edit(self, table: str, token: str, key: str, value: object) -> None:
        edit_table(self.root, table, lambda row: row.update({key: value}), token)


class Tables(Tree):
    def test_only_key_frames_of_cameras_and_lidar_are_kept(self):
        tables = load_tables(self.folder)
        self.assertEqual(
            list(tables.sample), [f"sample-{scene}-{i}" for scene in (0, 1) for i in (0, 1, 2)]
        )
        frames = tables.frames["sample-1-2"]
        self.assertEqual(set(frames), {*CAMERA_CHANNELS, "LIDAR_TOP"})
        self.assertEqual(frames["CAM_BACK"].filename, "samples/CAM_BACK/n015__CAM_BACK__1-2.jpg")
        self.assertFalse(frames["CAM_FRONT"].filename.startswith("sweeps"))
        self.assertEqual(len(tables.ego_pose), 6 * 7)
        self.assertEqual(tables.location("sample-1-2"), "boston-seaport")

    def test_a_split_selects_its_scenes(self):
        split = self.root / "split.txt"
        split.write_text("# validation\n\n  scene-0002  # boston\n")
        self.assertEqual(read_scene_names(split), ["scene-0002"])
        tables = load_tables(self.folder, read_scene_names(split))
        self.assertEqual(list(tables.sample), [f"sample-1-{i}" for i in range(3)])
        self.assertEqual(len(tables.ego_pose), 3 * 7)

    def test_a_split_with_unknown_scenes_is_refused(self):
        with self.assertRaisesRegex(MissingSceneError, "scene.json: found no scene named scene-9"):
            load_tables(self.folder, ["scene-0001", "scene-9"])
        split = self.root / "split.txt"
        split.write_text("# nothing\n")
        with self.assertRaisesRegex(MissingSceneError, "split.txt: found no scene name"):
            read_scene_names(split)
        with self.assertRaisesRegex(MissingFileError, "absent.txt"):
            read_scene_names(self.root / "absent.txt")

    def test_the_version_must_be_unambiguous(self):
        self.assertEqual(find_version(self.root), self.folder)
        (self.root / "v1.0-trainval").mkdir()
        with self.assertRaisesRegex(MissingFileError, "found v1.0-mini, v1.0-trainval, wanted one"):
            find_version(self.root)
        self.assertEqual(find_version(self.root, VERSION), self.folder)
        with self.assertRaisesRegex(MissingFileError, "wanted v1.0-test"):
            find_version(self.root, "v1.0-test")

    def test_a_missing_table_is_named(self):
        (self.folder / "ego_pose.json").unlink()
        with self.assertRaisesRegex(MissingFileError, "ego_pose.json: cannot be opened"):
            load_tables(self.folder)

    def test_an_unreadable_table_is_named(self):
        path = self.folder / "sample.json"
        path.write_text(path.read_text()[:-20])
        with self.assertRaisesRegex(UnreadableJsonError, r"sample.json: line \d+, column \d+"):
            load_tables(self.folder)

    def test_a_wrong_type_is_named_with_table_and_record(self):
        self.edit("sample_data", "data-CAM_FRONT-0-0", "width", "1600")
        with self.assertRaisesRegex(
            WrongTypeError, r"sample_data.json: record \d+: 'width' is \"1600\", wanted a whole"
        ):
            load_tables(self.folder)


class MissingTokens(Tree):
    def test_a_sample_with_an_unknown_calibration_is_defective(self):
        self.edit("sample_data", "data-CAM_BACK-0-1", "calibrated_sensor_token", "lost")
        tables = load_tables(self.folder)
        with self.assertRaisesRegex(
            MissingTokenError,
            "calibrated_sensor.json: found no token 'lost', wanted by sample_data 'data-C",
        ):
            tables.frame("sample-0-1", "CAM_FRONT")
        self.assertEqual(list(tables.defects), ["sample-0-1"])

    def test_a_sample_of_an_unknown_scene_is_named(self):
        self.edit("sample", "sample-0-1", "scene_token", "lost")
        tables = load_tables(self.folder)
        with self.assertRaisesRegex(MissingTokenError, "scene.json: found no token 'lost'"):
            tables.location("sample-0-1")

    def test_a_scene_of_an_unknown_log_is_named(self):
        self.edit("scene", "scene-token-0", "log_token", "lost")
        with self.assertRaisesRegex(MissingTokenError, "log.json: found no .*'lost'.*scene-0001"):
            load_tables(self.folder).location("sample-0-0")

    def test_a_sample_without_one_of_its_frames_is_named(self):
        self.edit("sample_data", "data-CAM_BACK-0-1", "is_key_frame", False)
        with self.assertRaisesRegex(MissingFrameError, "found no key frame of CAM_BACK .*ple-0-1"):
            load_tables(self.folder).frame("sample-0-1", "CAM_BACK")


if __name__ == "__main__":
    unittest.main()
