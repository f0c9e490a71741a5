"""Reads logs of ROS 1 and 2 (.bag, .db3, .mcap, folders of bags) by the package rosbags. Every number of a message
becomes a column: `position/shoulder` of a JointState whose names hold shoulder, `pose/position/x` of a pose. Times are
those of the header where it has one, else those of the arrival."""
import dataclasses
import io
import math
import statistics
import sys

from logs.series import Series, in_order

MOST_NUMBERS = 64  # of one list in a message; longer ones are point clouds, maps, sounds
MOST_LATE = 60.0  # [s] from a stamp to its arrival; what is farther off is another clock, such as a simulator's
PER_PIXEL = {"rgb8": (3, (0, 1, 2)), "bgr8": (3, (2, 1, 0)), "rgba8": (4, (0, 1, 2)), "bgra8": (4, (2, 1, 0)),
             "mono8": (1, (0, 0, 0))}


def nanoseconds(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


def numbers_in(value, path=""):
    """Yields (path, number) of all numbers below a message, a list or a number."""
    if isinstance(value, bool) or (hasattr(value, "dtype") and value.dtype == bool and not value.shape):
        yield path, float(value)
    elif isinstance(value, (int, float)) or (hasattr(value, "dtype") and not value.shape):
        yield path, float(value)
    elif dataclasses.is_dataclass(value):
        yield from numbers_of_message(value, path)
    elif hasattr(value, "__len__") and not isinstance(value, (str, bytes)) and len(value) <= MOST_NUMBERS:
        for place, one in enumerate(value):
            yield from numbers_in(one, f"{path}/{name_of(one, place)}")


def name_of(one, place):
    """of an entry of a list: the frame or name that it tells, else its place"""
    for key in ("child_frame_id", "name"):
        if isinstance(getattr(one, key, None), str) and getattr(one, key):
            return getattr(one, key).replace("/", "_")
    return str(place)


def numbers_of_message(message, path):
    names = next((list(getattr(message, key)) for key in ("name", "joint_names")
                  if isinstance(getattr(message, key, None), (list, tuple)) and getattr(message, key)), None)
    for field in dataclasses.fields(message):
        if field.name in ("header", "layout") or field.name.startswith("__"):
            continue
        value = getattr(message, field.name)
        place = f"{path}/{field.name}" if path else field.name
        if field.name == "points" and names and len(value):
            # a trajectory tells where the joints have to be at last
            yield from numbers_of_lists(value[-1], names, place)
        elif names and hasattr(value, "__len__") and len(value) == len(names) and not isinstance(value[0], str):
            yield from ((f"{place}/{name}", float(one)) for name, one in zip(names, value))
        else:
            yield from numbers_in(value, place)


def numbers_of_lists(point, names, path):
    for field in ("positions", "velocities", "accelerations", "effort"):
        values = getattr(point, field, [])
        if len(values) == len(names):
            yield from ((f"{path}/{field}/{name}", float(one)) for name, one in zip(names, values))


def picture_of(message, topic):
    """[height, width, 3] of an Image or a CompressedImage"""
    import numpy
    import PIL.Image

    if not hasattr(message, "encoding"):
        return numpy.asarray(PIL.Image.open(io.BytesIO(bytes(message.data))).convert("RGB"))
    if message.encoding not in PER_PIXEL:
        return None
    n, order = PER_PIXEL[message.encoding]
    rows = numpy.asarray(message.data, dtype=numpy.uint8).reshape(message.height, message.step)
    return rows[:, :message.width * n].reshape(message.height, message.width, n)[:, :, list(order)]


def read(path):
    """Returns the Series of all topics and what was left out, with reasons. Exits with a sentence where the file is no
    such log."""
    import rosbags.highlevel
    import rosbags.typesys

    store = rosbags.typesys.get_typestore(rosbags.typesys.Stores.LATEST)
    try:
        with rosbags.highlevel.AnyReader([path], default_typestore=store) as reader:
            return read_topics(reader)
    except SystemExit:
        raise
    except Exception as error:  # of many kinds, all of a file that is not what it should be
        sys.exit(f"{path} cannot be read as a log of ROS: {error}")


def read_topics(reader):
    topics, left_out = {}, []
    for connection in reader.connections:
        if connection.msgtype not in reader.typestore.types:
            left_out.append(f"{connection.topic}: its type {connection.msgtype} is not described in the log")
    skipped = set()
    known = [one for one in reader.connections if one.msgtype in reader.typestore.types]
    for connection, arrival, raw in reader.messages(connections=known):
        topic = connection.topic
        if topic in skipped:
            continue
        message = reader.deserialize(raw, connection.msgtype)
        rows = topics.setdefault(topic, {"kind": connection.msgtype, "rows": [], "pictures": [], "arrivals": [], "stamps": []})
        stamp = nanoseconds(message.header.stamp) if hasattr(message, "header") else 0
        if connection.msgtype.endswith(("/Image", "/CompressedImage")):
            picture = picture_of(message, topic)
            if picture is None:
                left_out.append(f"{topic}: pictures of the encoding {message.encoding}; rgb8, bgr8, mono8 are read")
                skipped.add(topic)
                del topics[topic]
                continue
            rows["pictures"].append(picture)
        else:
            if not stamp and connection.msgtype.endswith("/TFMessage") and message.transforms:
                stamp = nanoseconds(message.transforms[0].header.stamp)
            rows["rows"].append(dict(numbers_in(message)))
        # from the log's begin: seconds since 1970 have no room for nanoseconds
        rows["arrivals"].append(1e-9 * (arrival - reader.start_time))
        if stamp:
            rows["stamps"].append(1e-9 * (stamp - reader.start_time))
    found = []
    for topic, read in topics.items():
        names = list(dict.fromkeys(name for row in read["rows"] for name in row))
        if not names and not read["pictures"]:
            left_out.append(f"{topic}: {read['kind']} holds no numbers, or longer lists than {MOST_NUMBERS}")
            continue
        columns = {name: [row.get(name, math.nan) for row in read["rows"]] for name in names}
        times, delay = times_of(topic, read["stamps"], read["arrivals"])
        found.append(in_order(Series(topic, read["kind"], times, columns, read["pictures"], delay)))
    return found, left_out


def times_of(topic, stamps, arrivals):
    """The stamps where every message has one of the log's clock, else the arrivals; and the delay between them."""
    if len(stamps) < len(arrivals):
        return arrivals, math.nan
    delay = statistics.median(arrival - stamp for stamp, arrival in zip(stamps, arrivals))
    if abs(delay) <= MOST_LATE:
        return stamps, delay
    print(f"note: {topic}: its stamps are {abs(delay):.6g} s away from the log's clock; arrivals are used",
          file=sys.stderr)
    return arrivals, math.nan
