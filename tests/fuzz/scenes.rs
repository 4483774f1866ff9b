//! Whole scenes: assembled from parts that fit each other, so that most can be rendered, and then changed in up to three places as the
//! schema allows, so that faults arise from combinations.

use serde_json::{Map, Value, json};

use crate::schema::{Maker, toml};

type Table = Map<String, Value>;

impl Maker {
    /// A scene file with a camera, things, and most often light.
    pub fn whole_scene(&mut self) -> String {
        let mut scene = Table::new();
        let spectral = self.one_in(3);
        scene.insert("camera".into(), self.camera());
        let count = 1 + self.below(4);
        let objects: Vec<Value> = (0..count).map(|k| self.object(k, spectral)).collect();
        scene.insert("object".into(), objects.into());
        if spectral {
            let continuation = self.one_of(&["dark", "edge", "blackbody"]);
            scene.insert(
                "radiance".into(),
                json!({"quantity": "rgb", "continuation": continuation}),
            );
        } else if self.one_in(3) {
            scene.insert("radiance".into(), self.quantity_of_radiance());
        }
        if self.one_in(2) {
            let count = 1 + self.below(3);
            let lights: Vec<Value> = (0..count).map(|k| self.light(k, spectral)).collect();
            scene.insert("light".into(), lights.into());
        }
        if self.one_in(3) {
            scene.insert("sky".into(), self.sky(spectral));
        }
        // What shines by itself is shown by nothing else, and the paper's world stands still.
        let text = Value::Object(scene.clone()).to_string();
        if !text.contains("\"area\"") && self.one_in(2) {
            let source = self.source();
            scene.insert("source".into(), json!([source]));
        }
        if !text.contains("\"sky\"") {
            self.sometimes(&mut scene, 3, "display", Maker::display);
        }
        self.sometimes(
            &mut scene,
            3,
            "render",
            |m| json!({"bounces": m.below(6), "seed": m.below(9)}),
        );
        self.sometimes(&mut scene, 8, "model", |_| json!("paper2015"));
        self.sometimes(
            &mut scene,
            8,
            "medium",
            |m| json!({"index": m.number_of(&[1.0, 1.33, 2.5])}),
        );
        self.sometimes(&mut scene, 6, "effects", |m| {
            let mut on = || m.one_in(2);
            json!({"aberration": on(), "doppler": on(), "retardation": on(), "searchlight": on()})
        });
        self.sometimes(&mut scene, 5, "outside", |m| {
            m.choice([json!("hold"), json!("black"), json!({"mark": [1.0, 0.0, 1.0]}),
                json!({"before": "hold", "after": "black", "off_texture": {"mark": [0.0, 1.0, 0.0]}})])
        });
        self.sometimes(&mut scene, 10, "panel", |m| {
            let show = m.one_of(&["picture", "isochrones", "luminance"]);
            json!([{"name": "one", "set": {"camera.time": m.time()}},
                   {"name": "two", "show": show, "set": {"camera.velocity": m.velocity()}}])
        });
        self.sometimes(&mut scene, 8, "diagram", |m| {
            json!({"worldline": [{"name": "A", "velocity": 0.5, "ticks": 1.0}, {"name": "C", "of": "camera"},
                    {"name": "O", "of": "o0"}],
                "event": [{"name": "E", "at": [1.0, m.number()]}],
                "frame": [{"name": "S'", "velocity": m.number().clamp(-0.9, 0.9), "axes": true}]})
        });
        let mut scene = Value::Object(scene);
        for _ in 0..[0, 0, 0, 1, 1, 2][self.below(6)] {
            self.change(&mut scene);
        }
        // Cameras, lights and skies of files, of which there are none here, are refused by their first key.
        for table in ["camera", "light", "sky"] {
            let one = scene.get_mut(table).into_iter();
            let all = one.flat_map(|entry| match entry {
                Value::Array(entries) => entries.iter_mut().collect(),
                entry => vec![entry],
            });
            for entry in all.filter_map(Value::as_object_mut) {
                entry.retain(|key, _| !["gltf", "node", "image"].contains(&key.as_str()));
            }
        }
        let lines = scene.as_object().into_iter().flatten();
        lines
            .map(|(key, value)| format!("{key} = {}\n", toml(value)))
            .collect()
    }

    fn below(&mut self, n: usize) -> usize {
        self.numbers.below(n)
    }

    fn one_of(&mut self, all: &[&'static str]) -> &'static str {
        all[self.below(all.len())]
    }

    fn number_of(&mut self, all: &[f64]) -> f64 {
        all[self.below(all.len())]
    }

    fn choice<const N: usize>(&mut self, all: [Value; N]) -> Value {
        all[self.below(N)].clone()
    }

    fn sometimes(
        &mut self,
        table: &mut Table,
        rarity: usize,
        key: &str,
        of: impl FnOnce(&mut Maker) -> Value,
    ) {
        if self.one_in(rarity) {
            table.insert(key.into(), of(self));
        }
    }

    /// From −`size` to `size`, in coarse steps so that things coincide, or in fine ones.
    fn length(&mut self, size: f64) -> f64 {
        let steps = [2, 2000][self.below(2)];
        size * (self.below(2 * steps + 1) as f64 / steps as f64 - 1.0)
    }

    fn vector(&mut self, size: f64) -> Value {
        json!([self.length(size), self.length(size), self.length(size)])
    }

    /// Of any length but 0.
    fn axis(&mut self) -> Value {
        self.choice([
            json!([0.0, 1.0, 0.0]),
            json!([0.0, 0.0, -1.0]),
            json!([1.0, 1.0, 1.0]),
            json!([1e-9, -1.0, 0.0]),
            json!([-3.0, 0.5, 2.0]),
        ])
    }

    fn colour(&mut self) -> Value {
        self.choice([
            json!([0.8, 0.7, 0.1]),
            json!([0.0, 0.0, 0.0]),
            json!([1.0, 1.0, 1.0]),
            json!([0.0, 5.0, 0.0]),
        ])
    }

    fn brightness(&mut self) -> Value {
        self.choice([
            json!(1.0),
            json!(0.0),
            json!(1e6),
            json!([3.0, 2.0, 1.0]),
            json!(1e-30),
        ])
    }

    fn time(&mut self) -> &'static str {
        self.one_of(&[
            "0 m", "1 m", "-3 m", "4.5 m", "1 ns", "-20 ns", "1e6 m", "-1e9 m", "1e-6 m",
        ])
    }

    fn positive_time(&mut self) -> &'static str {
        self.one_of(&["1 m", "5 cm", "2 ns", "100 m", "1e-6 m", "1e6 m"])
    }

    fn angle(&mut self) -> &'static str {
        self.one_of(&["30 deg", "90 deg", "1 deg", "-75 deg", "360 deg", "1 rad"])
    }

    fn velocity(&mut self) -> Value {
        match self.below(7) {
            0 => json!({"beta": [self.length(0.57), self.length(0.57), self.length(0.57)]}),
            1 => {
                json!({"beta": self.number_of(&[0.0, 0.5, 0.9, 0.999_999]), "direction": self.axis()})
            }
            2 => {
                json!({"gamma": self.number_of(&[1.0, 1.5, 100.0, 1e9]), "direction": self.axis()})
            }
            3 => {
                json!({"rapidity": self.number_of(&[0.0, 1.0, -3.0, 40.0]), "direction": self.axis()})
            }
            4 => {
                json!({"one_minus_beta": self.number_of(&[1e-3, 1e-15, 1e-30]), "direction": self.axis()})
            }
            5 => json!({"beta": [0.0, 0.0, -0.5]}),
            _ => json!({"beta": [0.6, 0.0, 0.0]}),
        }
    }

    fn acceleration(&mut self) -> Value {
        let proper = self.one_of(&[
            "0.1 /m",
            "-0.5 /m",
            "9.81 m/s2",
            "3 /m",
            "0 /m",
            "0.03 c/ns",
            "1e-9 /m",
        ]);
        json!({"proper": proper, "direction": self.axis()})
    }

    /// For a camera or a light; what it takes the place of is to be left out.
    fn motion(&mut self) -> (Value, &'static [&'static str]) {
        match self.below(5) {
            0 => (json!({"acceleration": self.acceleration()}), &[]),
            1 => {
                let segments = json!([{"duration": self.positive_time(), "acceleration": self.acceleration()},
                    {"duration": self.positive_time()}, {"acceleration": self.acceleration()}]);
                (json!({"segments": segments}), &[])
            }
            2 => {
                let profile = json!([{"time": "-5 m"}, {"time": "0 m", "acceleration": self.acceleration()},
                    {"time": "2 m", "acceleration": self.acceleration()}, {"time": "9 m"}]);
                let axes = self.one_of(&["gyroscope", "world"]);
                (json!({"profile": profile, "axes": axes}), &[])
            }
            3 => {
                let frames = json!([{"time": "-20 m", "position": [0.0, 0.0, 6.0]}, {"time": "-8 m", "position": [1.0, 0.0, 5.0]},
                    {"time": "0 m", "position": self.vector(2.0)}, {"time": "30 m", "position": [0.0, 1.0, 9.0]}]);
                (
                    json!({"keyframes": frames}),
                    &["eye", "position", "velocity", "clock_zero"],
                )
            }
            _ => {
                let circle = match self.one_in(2) {
                    true => {
                        json!({"centre": [0.0, 0.0, 0.0], "axis": self.axis(), "period": "100 m"})
                    }
                    false => {
                        json!({"centre": [9.0, 0.0, 0.0], "axis": self.axis(), "rate": "-0.05 rad/m"})
                    }
                };
                (json!({"circle": circle}), &["velocity"])
            }
        }
    }

    fn camera(&mut self) -> Value {
        let mut camera = Table::new();
        let eye = self.choice([
            json!([0.0, 0.0, 4.0]),
            json!([1.0, 2.0, 3.0]),
            json!([0.1, 0.2, 0.3]),
            json!([0.0, 50.0, 1e-3]),
            json!([1e6, 0.0, 0.0]),
        ]);
        camera.insert("eye".into(), eye);
        camera.insert(
            "look_at".into(),
            self.choice([json!([0.0, 0.0, 0.0]), json!([0.3, -0.2, 0.1])]),
        );
        self.sometimes(&mut camera, 4, "up", Maker::axis);
        self.sometimes(&mut camera, 2, "velocity", Maker::velocity);
        self.sometimes(&mut camera, 2, "time", |m| m.time().into());
        self.sometimes(&mut camera, 4, "clock_zero", |m| m.time().into());
        self.sometimes(&mut camera, 4, "projection", |m| {
            m.one_of(&[
                "perspective",
                "fisheye_equidistant",
                "fisheye_equisolid",
                "fisheye_orthographic",
                "equirectangular",
            ])
            .into()
        });
        self.sometimes(&mut camera, 3, "hfov", |m| {
            m.one_of(&["40 deg", "120 deg", "0.001 deg", "179 deg"])
                .into()
        });
        if !camera.contains_key("projection") && self.one_in(3) {
            let assembly = self.one_of(&["rigid", "world_length", "bell"]);
            let focal_length = self.one_of(&["36 mm", "1 m", "1 um"]);
            camera.insert(
                "sensor".into(),
                json!({"focal_length": focal_length, "assembly": assembly}),
            );
        }
        let elements: &[&str] = match camera.contains_key("sensor") {
            true => &["exact", "comoving", "aberrated"],
            false => &["exact"],
        };
        self.sometimes(&mut camera, 8, "rotation", |m| {
            json!({"axis": m.axis(), "rate": m.one_of(&["0.5 rad/m", "-20 deg/ns"]), "elements": m.one_of(elements)})
        });
        self.sometimes(&mut camera, 4, "shutter", |m| {
            let integration = m.one_of(&["moments", "means"]);
            let records = m.one_of(&["mean", "energy"]);
            json!({"duration": m.positive_time(), "integration": integration, "records": records})
        });
        self.sometimes(
            &mut camera,
            12,
            "stereo",
            |_| json!({"interpupillary_distance": "6 cm"}),
        );
        if self.one_in(4) {
            let (motion, replaced) = self.motion();
            camera.insert("motion".into(), motion);
            replaced.iter().for_each(|key| drop(camera.remove(*key)));
        }
        camera.into()
    }

    fn object(&mut self, number: usize, spectral: bool) -> Value {
        const MODELS: [&str; 6] = [
            "corner/corner.glb",
            "gallery/die.glb",
            "gallery/barn.glb",
            "../tests/data/valid/textured.glb",
            "../tests/data/valid/topologies.glb",
            "../tests/data/valid/materials.gltf",
        ];
        let mut object = Table::new();
        object.insert("name".into(), format!("o{number}").into());
        if self.one_in(5) {
            object.insert("gltf".into(), self.one_of(&MODELS).into());
        } else {
            object.insert("shape".into(), self.shape());
            match spectral && self.one_in(3) {
                true => drop(object.insert("spectrum".into(), self.spectrum())),
                false => self.sometimes(&mut object, 2, "colour", Maker::colour),
            }
            for key in ["metallic", "roughness", "transmission"] {
                self.sometimes(&mut object, 3, key, |m| {
                    [0.0, 1.0, 0.5, 1e-3][m.below(4)].into()
                });
            }
            self.sometimes(&mut object, 6, "ior", |m| {
                [1.0, 1.5, 10.0][m.below(3)].into()
            });
        }
        self.sometimes(&mut object, 2, "transform", |m| {
            let mut transform = Table::new();
            m.sometimes(&mut transform, 2, "translate", |m| m.vector(2.0));
            m.sometimes(&mut transform, 2, "scale", |m| {
                m.choice([json!(2.0), json!(-1.0), json!([1.0, 1e-6, 3.0]), json!(1e5)])
            });
            m.sometimes(
                &mut transform,
                2,
                "rotate",
                |m| json!({"axis": m.axis(), "angle": m.angle()}),
            );
            transform.into()
        });
        self.sometimes(&mut object, 2, "velocity", Maker::velocity);
        self.sometimes(
            &mut object,
            2,
            "origin",
            |m| json!({"position": m.vector(2.0), "time": m.time()}),
        );
        object.into()
    }

    fn shape(&mut self) -> Value {
        match self.below(4) {
            0 => {
                json!({"box": {"size": self.choice([json!([1.0, 1.0, 1.0]), json!([4.0, 1e-9, 2.0]), json!([1e4, 1e4, 1e4])])}})
            }
            1 => {
                json!({"sphere": {"radius": self.number_of(&[1.0, 1e-6, 0.3, 1e6]), "subdivisions": self.below(4)}})
            }
            2 => json!({"plane": {"size": self.choice([json!([2.0, 2.0]), json!([1e5, 1e-5])])}}),
            _ => {
                json!({"lattice": {"cells": [1 + self.below(3), 1 + self.below(3), 1], "spacing": 0.7, "bar": 0.1}})
            }
        }
    }

    fn spectrum(&mut self) -> Value {
        let mut spectrum = match self.below(6) {
            0 => json!({"line": "589 nm"}),
            1 => {
                json!({"lines": [{"wavelength": "656 nm", "energy": 2.0}, {"wavelength": "486 nm"}]})
            }
            2 => json!({"blackbody": self.one_of(&["5800 K", "2.725 K", "1e7 K"])}),
            3 => json!({"gaussian": {"centre": "550 nm", "sigma": "20 nm"}}),
            4 => json!({"flat": ["300 nm", "2 um"]}),
            _ => json!({"rgb": self.colour()}),
        };
        if self.one_in(3) {
            spectrum["total"] = json!(2.0);
        }
        spectrum
    }

    fn emission(&mut self) -> Value {
        match self.below(4) {
            0 => json!({"gaussian": {"sigma": self.positive_time(), "time": self.time()}}),
            1 => json!({"train": {"sigma": "5 cm", "period": "1 m"}}),
            2 => {
                json!({"train": {"sigma": "5 cm", "period": "1 m", "count": 1 + self.below(1000), "time": self.time()}})
            }
            _ => {
                json!({"table": [{"time": "-2 m", "factor": 0.0}, {"time": "0 m", "factor": 1.0}, {"time": "9 m", "factor": 0.5}]})
            }
        }
    }

    fn light(&mut self, number: usize, spectral: bool) -> Value {
        // One shining body is enough.
        let kinds = ["point", "spot", "directional", "area"];
        let kind = self.one_of(&kinds[..kinds.len() - number.min(1)]);
        let mut light = Table::new();
        light.insert("type".into(), kind.into());
        let how_bright = match kind {
            "point" | "spot" => {
                light.insert("position".into(), self.vector(3.0));
                ["intensity", "power"][self.below(2)]
            }
            "directional" => "irradiance",
            _ => {
                light.insert("object".into(), "o0".into());
                ["radiance", "power"][self.below(2)]
            }
        };
        if kind == "spot" || kind == "directional" {
            light.insert("direction".into(), self.axis());
        }
        if kind == "spot" && self.one_in(2) {
            light.insert("inner".into(), "10 deg".into());
            light.insert("outer".into(), "40 deg".into());
        }
        match spectral && self.one_in(3) {
            true => {
                light.insert("spectrum".into(), self.spectrum());
                light.insert(how_bright.into(), json!(3.0));
            }
            false => self.sometimes(&mut light, 2, how_bright, Maker::brightness),
        }
        if kind != "area" {
            self.sometimes(&mut light, 3, "velocity", Maker::velocity);
            self.sometimes(&mut light, 4, "clock_zero", |m| m.time().into());
        }
        if matches!(kind, "point" | "spot") && self.one_in(4) {
            let (motion, replaced) = self.motion();
            light.insert("motion".into(), motion);
            replaced.iter().for_each(|key| drop(light.remove(*key)));
        }
        self.sometimes(&mut light, 3, "emission", Maker::emission);
        self.sometimes(&mut light, 4, "shadows", |_| false.into());
        light.into()
    }

    fn sky(&mut self, spectral: bool) -> Value {
        let mut sky = Table::new();
        match self.below(4) {
            0 => drop(sky.insert("radiance".into(), self.brightness())),
            1 => drop(sky.insert("gradient".into(), json!({"zenith": self.colour()}))),
            2 if spectral => drop(sky.insert("spectrum".into(), self.spectrum())),
            _ => {}
        }
        self.sometimes(&mut sky, 2, "sun", |m| {
            json!({"direction": m.axis(), "irradiance": m.brightness(), "diameter": m.one_of(&["0.5 deg", "90 deg", "1e-6 deg"])})
        });
        self.sometimes(
            &mut sky,
            3,
            "stars",
            |m| json!({"count": m.below(300), "seed": m.below(9)}),
        );
        self.sometimes(&mut sky, 4, "lights", |_| false.into());
        self.sometimes(&mut sky, 4, "shadows", |_| false.into());
        sky.into()
    }

    fn source(&mut self) -> Value {
        let mut source = match self.one_in(2) {
            true => {
                json!({"pulse": {"position": self.vector(3.0), "sigma": self.positive_time(), "time": self.time(),
                "intensity": self.brightness(), "shadows": self.one_in(2)}})
            }
            false => json!({"cube": self.cube()}),
        };
        if self.one_in(2) {
            source["objects"] = json!(["o0"]);
        }
        source
    }

    fn cube(&mut self) -> Value {
        let mut cube = Table::new();
        let clock = self.one_of(&["world", "object", "capture"]);
        cube.insert("clock".into(), clock.into());
        let file = self.one_of(&[
            "corner/capture_rgb.npz",
            "corner/lightmap.npz",
            "../tests/data/valid/cube-f4.npy",
        ]);
        cube.insert("file".into(), file.into());
        cube.insert("bin_width".into(), self.positive_time().into());
        self.sometimes(&mut cube, 2, "start", |m| m.time().into());
        self.sometimes(&mut cube, 2, "values", |m| {
            m.one_of(&["per_bin", "density"]).into()
        });
        self.sometimes(&mut cube, 2, "filter", |m| {
            m.one_of(&["nearest", "linear", "cubic", "cubic_means"])
                .into()
        });
        self.sometimes(&mut cube, 4, "reconstruction", |m| {
            m.one_of(&["bilinear", "sharp", "footprint"]).into()
        });
        match clock == "capture" || self.one_in(2) {
            true => drop(cube.insert(
                "capture".into(),
                json!({"eye": [3.2, 3.0, 4.6], "look_at": [0.0, 0.0, 0.0], "hfov": "45 deg"}),
            )),
            false => drop(cube.insert("uv".into(), 0.into())),
        }
        cube.into()
    }

    fn quantity_of_radiance(&mut self) -> Value {
        let quantity = self.one_of(&[
            "integrated",
            "per_wavelength",
            "per_frequency",
            "line",
            "photons",
            "photons_per_wavelength",
            "photons_per_frequency",
        ]);
        match quantity {
            "line" => json!({"quantity": quantity, "wavelength": "532 nm"}),
            _ => json!({"quantity": quantity}),
        }
    }

    fn display(&mut self) -> Value {
        let mut display = Table::new();
        self.sometimes(&mut display, 2, "back_faces", |m| {
            m.one_of(&["as_file", "two_sided", "black", "culled"])
                .into()
        });
        self.sometimes(&mut display, 3, "background", Maker::colour);
        match self.below(3) {
            0 => drop(display.insert("white".into(), [1.0, 1e-9, 1e9][self.below(3)].into())),
            1 => drop(display.insert(
                "exposure".into(),
                self.one_of(&["97 %", "0 %", "100 %"]).into(),
            )),
            _ => {}
        }
        self.sometimes(
            &mut display,
            6,
            "isochrones",
            |m| json!({"flash": m.vector(3.0), "time": m.time()}),
        );
        self.sometimes(&mut display, 6, "logarithmic", |_| json!([1e-3, 10.0]));
        self.sometimes(&mut display, 6, "caption", |_| json!("β = {beta}"));
        display.into()
    }

    /// Changes one value as the schema has it: another one of its type, a key more, or one less.
    fn change(&mut self, scene: &mut Value) {
        let schema = self.schema.clone();
        self.change_within(scene, &schema, 0);
    }

    fn change_within(&mut self, value: &mut Value, schema: &Value, depth: usize) {
        if let Some(name) = schema["$ref"].as_str().and_then(|r| r.rsplit('/').next()) {
            let of = self.schema["$defs"][name].clone();
            return self.change_within(value, &of, depth);
        }
        let choices = ["anyOf", "oneOf"]
            .into_iter()
            .find_map(|key| schema[key].as_array());
        if let Some(choices) = choices {
            let of = self.pick(choices);
            return self.change_within(value, &of, depth);
        }
        let properties = schema["properties"].as_object();
        match (value, properties) {
            (Value::Object(table), Some(properties)) if !properties.is_empty() => {
                let keys: Vec<String> = table.keys().cloned().collect();
                let key = keys
                    .get(self.below(keys.len()))
                    .cloned()
                    .unwrap_or_default();
                match self.below(6) {
                    // At least the scene itself stays.
                    0 if depth > 1 => drop(table.remove(&key)),
                    1 | 2 => {
                        let names: Vec<&String> = properties.keys().collect();
                        let name = names[self.below(names.len())];
                        let new = self.value(&properties[name], depth + 1);
                        table.insert(name.clone(), new);
                    }
                    _ => {
                        // Of two kinds of tables the other may have been picked.
                        let inner = table.get_mut(&key);
                        if let (Some(inner), Some(of)) = (inner, properties.get(&key)) {
                            self.change_within(inner, of, depth + 1);
                        }
                    }
                }
            }
            (Value::Array(all), _)
                if !all.is_empty() && schema["items"].is_object() && !self.one_in(4) =>
            {
                let at = self.below(all.len());
                match self.one_in(6) {
                    true => all.insert(at, all[at].clone()),
                    false => self.change_within(&mut all[at], &schema["items"], depth + 1),
                }
            }
            (value, _) => *value = self.value(schema, depth + 1),
        }
    }
}
