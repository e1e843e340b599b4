"""STEP files of a box and of a cylinder, written by hand."""

import numpy as np

WHOLE = "ISO-10303-21;\n{}\nEND-ISO-10303-21;\n"
_HEAD = (
    "HEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('part','2026-01-01T00:00:00',(''),(''),'','','');\n"
    "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\n"
)
LENGTHS = {"mm": "SI_UNIT(.MILLI.,.METRE.)", "m": "SI_UNIT($,.METRE.)"}


class Writer:
    """Entities, each with its number."""

    def __init__(self):
        self.lines = []

    def __call__(self, kind, *arguments):
        """An entity with an empty name."""
        return self.plain(f"{kind}({','.join(['', *map(said, arguments)])})".replace("(,", "('',", 1))

    def plain(self, text):
        self.lines.append(text)
        return f"#{len(self.lines)}"

    def point(self, *xyz):
        return self("CARTESIAN_POINT", tuple(map(float, xyz)))

    def direction(self, *xyz):
        return self("DIRECTION", tuple(map(float, xyz)))

    def axes(self, origin, up, along):
        return self("AXIS2_PLACEMENT_3D", self.point(*origin), self.direction(*up), self.direction(*along))

    def line(self, start, along):
        return self("LINE", self.point(*start), self("VECTOR", self.direction(*along), 1.0))

    def face(self, surface, *edges):
        """Edges in order, each with whether it runs along."""
        oriented = [
            self.plain(f"ORIENTED_EDGE('',*,*,{edge},{'.T.' if along else '.F.'})") for edge, along in edges
        ]
        bound = self("FACE_OUTER_BOUND", self("EDGE_LOOP", oriented), True)
        return self("ADVANCED_FACE", [bound], surface, True)


def said(value):
    if isinstance(value, bool):
        return ".T." if value else ".F."
    if isinstance(value, (list, tuple)):
        return f"({','.join(map(said, value))})"
    return str(value)


def step_text(faces_of, *, unit="mm"):
    """A file with one solid, whose faces `faces_of` writes."""
    write = Writer()
    solid = write("MANIFOLD_SOLID_BREP", write("CLOSED_SHELL", faces_of(write)))
    length = write.plain(f"(LENGTH_UNIT() NAMED_UNIT(*) {LENGTHS[unit]})")
    angle = write.plain("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))")
    around = write.plain("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())")
    near = write.plain(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{length},'accuracy','')")
    context = write.plain(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({near})) "
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{around})) REPRESENTATION_CONTEXT('',''))"
    )
    shape = write("ADVANCED_BREP_SHAPE_REPRESENTATION", [solid], context)
    application = write.plain("APPLICATION_CONTEXT('mechanical design')")
    product = write.plain(f"PRODUCT('part','part','',({write.plain(f'PRODUCT_CONTEXT($,{application},$)')}))")
    formation = write.plain(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    design = write.plain(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = write.plain(f"PRODUCT_DEFINITION('design','',{formation},{design})")
    of = write.plain(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    write.plain(f"SHAPE_DEFINITION_REPRESENTATION({of},{shape})")
    data = "\n".join(f"#{k} = {text};" for k, text in enumerate(write.lines, start=1))
    return WHOLE.format(f"{_HEAD}DATA;\n{data}\nENDSEC;")


def cylinder(radius, height):
    """About z, from 0 to its height: a side with a seam, and two discs."""

    def faces(write):
        x, z, down = (1, 0, 0), (0, 0, 1), (0, 0, -1)
        ends = [write("VERTEX_POINT", write.point(radius, 0, level)) for level in (0, height)]
        low, high = (
            write(
                "EDGE_CURVE", end, end, write("CIRCLE", write.axes((0, 0, level), z, x), float(radius)), True
            )
            for end, level in zip(ends, (0, height), strict=True)
        )
        seam = write("EDGE_CURVE", *ends, write.line((radius, 0, 0), z), True)
        side = write("CYLINDRICAL_SURFACE", write.axes((0, 0, 0), z, x), float(radius))
        return [
            write.face(side, (low, True), (seam, True), (high, False), (seam, False)),
            write.face(write("PLANE", write.axes((0, 0, 0), down, x)), (low, False)),
            write.face(write("PLANE", write.axes((0, 0, height), z, x)), (high, True)),
        ]

    return faces


def box(size):
    """From the origin."""
    corners = [(a, b, c) for a in (0, size[0]) for b in (0, size[1]) for c in (0, size[2])]
    loops = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))

    def unit(a, b):
        return np.subtract(corners[b], corners[a]) / np.linalg.norm(np.subtract(corners[b], corners[a]))

    def faces(write):
        vertices = [write("VERTEX_POINT", write.point(*corner)) for corner in corners]
        edges = {}

        def edge(a, b):
            if (b, a) in edges:
                return edges[b, a], False
            line = write.line(corners[a], unit(a, b))
            edges[a, b] = write("EDGE_CURVE", vertices[a], vertices[b], line, True)
            return edges[a, b], True

        made = []
        for a, b, c, d in loops:
            sides = [edge(*pair) for pair in ((a, b), (b, c), (c, d), (d, a))]
            place = write.axes(corners[a], np.cross(unit(a, b), unit(a, d)), unit(a, b))
            made.append(write.face(write("PLANE", place), *sides))
        return made

    return faces
