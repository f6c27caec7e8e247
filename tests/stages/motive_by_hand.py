"""Writes a take as Motive exports it: y up, millimetres, and empty cells where a body was not seen."""

from pathlib import Path

from slidepipe.artifacts.recording import Recording


def write_take(recording: Recording, path: Path, *, units: str = "Millimeters", rotation: str = "Quaternion") -> Path:
    mocap = recording.mocap()
    scale = {"Meters": 1.0, "Millimeters": 1000.0}[units]
    settings = [
        "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,360.000000,Export Frame Rate,360.000000",
        f"Rotation Type,{rotation},Length Units,{units},Coordinate Space,Global",
    ]
    names = ["hand", "block"]
    heads = [
        ["", "Type", *["Rigid Body"] * 8, *["Rigid Body Marker"] * 4, *["Rigid Body"] * 8],
        ["", "Name", *["hand"] * 8, *["hand:Marker1"] * 4, *["block"] * 8],
        ["", "ID", *["A1"] * 8, *["A2"] * 4, *["B1"] * 8],
        [
            *["", ""],
            *["Rotation"] * 4, *["Position"] * 3, "Mean Marker Error",
            *["Position"] * 3, "Marker Quality",
            *["Rotation"] * 4, *["Position"] * 3, "Mean Marker Error",
        ],
        ["Frame", "Time (Seconds)", *"XYZW", *"XYZ", "", *"XYZ", "", *"XYZW", *"XYZ", ""],
    ]  # fmt: skip
    series = dict(zip(names, (mocap.hand, mocap.object), strict=True))
    rows = {name: {int(frame): index for index, frame in enumerate(one.sequence)} for name, one in series.items()}
    start = int(mocap.frames.ticks[0])
    lines = [",".join(settings), "", *(",".join(row) for row in heads)]
    for index, frame in enumerate(mocap.frames.frame.tolist()):
        time_s = (int(mocap.frames.ticks[index]) - start) / 1e7
        cells = [str(frame), f"{time_s:.6f}"]
        for name in names:
            place = rows[name].get(frame)
            cells += [""] * 8 if place is None else _cells(series[name], place, scale)
            cells += ["1.0", "2.0", "3.0", "1.0"] if name == "hand" else []
        lines.append(",".join(cells))
    path.write_text("\r\n".join(lines) + "\r\n")
    return path


def _cells(series, place: int, scale: float) -> list[str]:
    (x, y, z), (qx, qy, qz, qw) = series.position_m[place] * scale, series.quaternion_xyzw[place]
    return [*(f"{number:.6f}" for number in (qx, qz, -qy, qw, x, z, -y)), "0.1"]
