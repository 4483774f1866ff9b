"""Runs a vertex shader (OpenGL ES 3, without a window) on the vertices of a bundle's test vectors.

    python glsl.py SHADER BUNDLE

prints by how much of its tolerance each quantity is off at most. Exit code 77: there is no such OpenGL here.
"""
import ctypes, json, sys
import numpy as np

def library(*names):
    for name in names:
        try:
            return ctypes.CDLL(name)
        except OSError:
            pass
    print("no", names[0])
    sys.exit(77)

egl, gl = library("libEGL.so.1", "libEGL.so"), library("libGLESv2.so.2", "libGLESv2.so")
for function in ("eglGetPlatformDisplay", "eglCreateContext"):
    getattr(egl, function).restype = ctypes.c_void_p

def context():
    """Makes a context current that draws on nothing."""
    surfaceless = 0x31DD
    display = ctypes.c_void_p(egl.eglGetPlatformDisplay(surfaceless, None, None))
    if not display.value or not egl.eglInitialize(display, None, None):
        sys.exit(77)
    egl.eglBindAPI(0x30A0)  # OpenGL ES
    config, count = ctypes.c_void_p(), ctypes.c_int()
    wanted = (ctypes.c_int * 5)(0x3040, 0x40, 0x3033, 0, 0x3038)  # OpenGL ES 3, no surface
    egl.eglChooseConfig(display, wanted, ctypes.byref(config), 1, ctypes.byref(count))
    version = (ctypes.c_int * 3)(0x3098, 3, 0x3038)
    made = ctypes.c_void_p(egl.eglCreateContext(display, config, None, version))
    if not made.value or not egl.eglMakeCurrent(display, None, None, made):
        sys.exit(77)
    # Without a window there is nothing to draw on, and without that no drawing: one pixel will do.
    names = (ctypes.c_uint * 2)()
    gl.glGenFramebuffers(1, names)
    gl.glGenRenderbuffers(1, ctypes.byref(names, 4))
    gl.glBindRenderbuffer(0x8D41, names[1])
    gl.glRenderbufferStorage(0x8D41, 0x8058, 1, 1)
    gl.glBindFramebuffer(0x8D40, names[0])
    gl.glFramebufferRenderbuffer(0x8D40, 0x8CE0, 0x8D41, names[1])

def program(source):
    """The shader, whose outputs are recorded."""
    made = gl.glCreateProgram()
    fragment = "#version 300 es\nprecision highp float; out vec4 c; void main() { c = vec4(1.0); }"
    for kind, text in ((0x8B31, source), (0x8B30, fragment)):
        shader = gl.glCreateShader(kind)
        text = ctypes.c_char_p(text.encode())
        gl.glShaderSource(shader, 1, ctypes.byref(text), None)
        gl.glCompileShader(shader)
        done, log = ctypes.c_int(), ctypes.create_string_buffer(4096)
        gl.glGetShaderiv(shader, 0x8B81, ctypes.byref(done))
        gl.glGetShaderInfoLog(shader, 4096, None, log)
        assert done.value, log.value.decode()
        gl.glAttachShader(made, shader)
    names = (ctypes.c_char_p * 3)(b"event", b"film_point", b"wavelength_ratio")
    gl.glTransformFeedbackVaryings(made, 3, names, 0x8C8C)  # interleaved
    gl.glLinkProgram(made)
    done = ctypes.c_int()
    gl.glGetProgramiv(made, 0x8B82, ctypes.byref(done))
    assert done.value, "the shader does not link"
    gl.glUseProgram(made)
    return made

def uniform(made, name, value):
    place = gl.glGetUniformLocation(made, name.encode())
    value = np.asarray(value, float)
    data = np.ascontiguousarray(value.T if value.ndim == 2 else value, np.float32)  # matrices by columns
    pointer = data.ctypes.data_as(ctypes.c_void_p)
    if value.ndim == 2:
        getattr(gl, f"glUniformMatrix{len(value)}fv")(place, 1, 0, pointer)
    else:
        getattr(gl, f"glUniform{value.size}fv")(place, 1, pointer)

def run(made, positions):
    """Seven numbers for each vertex."""
    data, out = np.ascontiguousarray(positions, np.float32), np.zeros((len(positions), 7), np.float32)
    buffers = (ctypes.c_uint * 2)()
    gl.glGenBuffers(2, buffers)
    gl.glBindBuffer(0x8892, buffers[0])
    gl.glBufferData(0x8892, ctypes.c_ssize_t(data.nbytes), data.ctypes.data_as(ctypes.c_void_p), 0x88E4)
    place = gl.glGetAttribLocation(made, b"position")
    gl.glEnableVertexAttribArray(place)
    gl.glVertexAttribPointer(place, 3, 0x1406, 0, 0, None)
    gl.glBindBufferBase(0x8C8E, 0, buffers[1])
    gl.glBufferData(0x8C8E, ctypes.c_ssize_t(out.nbytes), None, 0x88E9)
    gl.glEnable(0x8C89)  # no rasterizing
    gl.glBeginTransformFeedback(0)
    gl.glDrawArrays(0, 0, len(positions))
    gl.glEndTransformFeedback()
    gl.glFinish()
    gl.glMapBufferRange.restype = ctypes.c_void_p
    found = gl.glMapBufferRange(0x8C8E, ctypes.c_ssize_t(0), ctypes.c_ssize_t(out.nbytes), 1)
    assert found, "nothing was recorded"
    ctypes.memmove(out.ctypes.data_as(ctypes.c_void_p), found, out.nbytes)
    return out.astype(float)

shader, folder = sys.argv[1:]
bundle, tests = (json.load(open(f"{folder}/{name}.json")) for name in ("bundle", "vectors"))
context()
made = program(open(shader).read())
G = np.diag([-1.0, 1, 1, 1])
camera = bundle["camera"]
L, P = np.array(camera["world_from_camera"]), np.array(camera["shot_event"])
uniform(made, "camera_from_world", G @ L.T @ G)
uniform(made, "camera_velocity", G @ L[:, 0])
uniform(made, "shot_event", P)
uniform(made, "axes", np.array([camera[axis] for axis in ("right", "up", "forward")]).T)
uniform(made, "tan_half_fov", camera["tan_half_fov"])
uniform(made, "size", camera["size"])
uniform(made, "near", [0.01])
for entry, test in zip(bundle["objects"], tests["objects"], strict=True):
    M = np.array(entry["world_from_object"])
    uniform(made, "world_from_object", M)
    uniform(made, "object_velocity", G @ M[:, 0])
    uniform(made, "shot", (G @ M.T @ G @ (P - np.array(entry["origin"])))[1:])
    vectors, tolerance = test["vectors"], test["tolerance_single"]
    found = run(made, [v["position"] for v in vectors])
    seen = [v["film"] is not None for v in vectors]
    off = {
        "event": np.abs(found[:, :4] - [v["event"] for v in vectors]),
        "film": np.abs(found[seen, 4:6] - np.array([v["film"] for v in vectors if v["film"]]).reshape(-1, 2)),
        "wavelength_ratio": np.abs(found[:, 6] - [v["wavelength_ratio"] for v in vectors]),
    }
    for name, off in off.items():
        part = off.max(initial=0) / tolerance[name]
        print(f"{entry['name']}: {name} is off by {part:.2f} of its tolerance {tolerance[name]:.3g}")
        assert part <= 1
