// Functions 20, 21 and 24: MODBUS Application Protocol Specification V1.1b3, sections 6.14, 6.15
// and 6.18 and their state diagrams. A file is 10000 records of 16 bits at most. What is written is
// put back.
#include <algorithm>
#include <array>

#include "conform/bytes.h"
#include "conform/modbus/modbus_trial.h"
#include "conform/modbus/modbus_words.h"

namespace rigwire::conform {

namespace modbus = protocols::modbus;
using modbus::ExceptionCode;

namespace {

using T = ModbusTrial;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kRead = 20;
constexpr std::uint8_t kWrite = 21;
constexpr std::uint8_t kQueue = 24;
constexpr unsigned kReference = 6;  // The only reference type.
constexpr unsigned kRecords = 10'000;
constexpr unsigned kMostQueued = 31;

/// A part of a request: `count` records of a file from there.
struct Group {
  unsigned file = 0;
  unsigned record = 0;
  unsigned count = 1;
  unsigned type = kReference;
};

Bytes head_of(const Group& group) {
  return fields_pdu(static_cast<std::uint8_t>(group.type), {group.file, group.record, group.count});
}

Pdu read_request(const std::vector<Group>& groups) {
  Bytes all;
  for (const Group& group : groups) {
    all = std::move(all) + head_of(group);
  }
  return Pdu{kRead, static_cast<std::uint8_t>(all.size())} + all;
}

Pdu write_request(const Group& group, const Bytes& data) {
  const Bytes all = head_of(group) + data;
  return Pdu{kWrite, static_cast<std::uint8_t>(all.size())} + all;
}

/// The records of each group; nothing where the answer is otherwise than asked, which is found.
std::optional<std::vector<Bytes>> read(T& trial, const std::vector<Group>& groups) {
  const auto data = trial.accepts(read_request(groups));
  if (!data || !trial.expect(!data->empty() && data->size() == 1U + data->front(),
                             "a length, and as many bytes", hex_text(*data, 16))) {
    return std::nullopt;
  }
  std::vector<Bytes> all;
  std::size_t at = 1;
  for (const Group& group : groups) {
    const std::size_t bytes = std::size_t{2} * group.count;
    if (!trial.expect(at + 2 + bytes <= data->size() && (*data)[at] == 1 + bytes &&
                          (*data)[at + 1] == kReference,
                      "of each group its length with the reference type, 6, and its records",
                      hex_text(*data, 32))) {
      return std::nullopt;
    }
    const auto begin = data->begin() + static_cast<std::ptrdiff_t>(at) + 2;
    all.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(bytes));
    at += 2 + bytes;
  }
  return trial.expect(at == data->size(), "no group more than was asked for", hex_text(*data, 32))
             ? std::optional(all)
             : std::nullopt;
}

Group first_in(const std::vector<RecordRange>& files, unsigned most = 1) {
  const RecordRange& range = files.front();
  return {range.file, range.records.first,
          static_cast<unsigned>(std::min<std::size_t>(most, range.records.size()))};
}
Group first(const T& trial, unsigned most = 1) {
  return first_in(trial.claims().files, most);
}
Group writable(const T& trial) {
  return first_in(trial.claims().writable_files);
}

void refused(T& trial, const Group& group, ExceptionCode code) {
  trial.refuses(read_request({group}), code);
}

void reads_one(T& trial) {
  static_cast<void>(read(trial, {first(trial)}));
}

void reads_twice(T& trial) {
  const auto one = read(trial, {first(trial)});
  const auto two = one ? read(trial, {first(trial)}) : std::nullopt;
  if (two) {
    trial.expect(*one == *two, "the same record again", hex_text(two->front()));
  }
}

void reads_groups(T& trial) {
  const RecordRange& range = trial.claims().files.front();
  const Group last{range.file, range.records.last};
  const auto both = read(trial, {first(trial), last});
  const auto one = both ? read(trial, {first(trial)}) : std::nullopt;
  const auto two = one ? read(trial, {last}) : std::nullopt;
  if (two) {
    trial.expect(both->front() == one->front() && both->back() == two->front(),
                 "of two groups the records of each alone", hex_text(both->front() + both->back()));
  }
}

void reads_block(T& trial) {
  // Max number of records in a response.
  constexpr unsigned kMost = 120;
  const Group block = first(trial, kMost);
  const auto whole = read(trial, {block});
  for (unsigned i = 0; whole && i < std::min(block.count, 4U); ++i) {
    const auto one = read(trial, {{block.file, block.record + i}});
    if (!one) {
      return;
    }
    trial.expect(
        std::equal(one->front().begin(), one->front().end(), whole->front().begin() + 2 * i),
        "each record alone as in a block", hex_text(one->front()));
  }
}

void beyond_the_file(T& trial) {
  const RecordRange& range = trial.claims().files.front();
  if (range.records.last + 1U >= kRecords) {
    return trial.not_applicable("the file has all 10000 records");
  }
  refused(trial, {range.file, range.records.last, 2}, ExceptionCode::illegal_data_address);
}

/// A file that is not claimed.
void other_file(T& trial) {
  const auto& files = trial.claims().files;
  unsigned file = 1;
  while (std::ranges::any_of(files, [&](const RecordRange& each) { return each.file == file; })) {
    ++file;
  }
  refused(trial, {file, 0}, ExceptionCode::illegal_data_address);
}

void cut_off(T& trial) {
  Pdu request = read_request({first(trial)});
  request.pop_back();
  trial.refuses(request, ExceptionCode::illegal_data_value);
}

void odd_length(T& trial) {
  Pdu request = read_request({first(trial)});
  request[1] = 6;
  request.pop_back();
  trial.refuses(request, ExceptionCode::illegal_data_value);
}

void too_long(T& trial) {
  // 35 groups are 245 bytes, the most; the begin of another still fits into a data unit.
  Pdu request = read_request(std::vector<Group>(35, first(trial)));
  request.push_back(kReference);
  ++request[1];
  trial.refuses(request, ExceptionCode::illegal_data_value);
}

/// Runs with the writable record as it is, and puts it back.
template <class Act>
void kept(T& trial, const Act& act) {
  const Group group = writable(trial);
  const auto before = read(trial, {group});
  if (!before) {
    return;
  }
  Bytes turned = before->front();
  turned.back() = static_cast<std::uint8_t>(turned.back() ^ 1U);
  act(group, before->front(), turned);
  static_cast<void>(trial.ask(write_request(group, before->front())));
}

void writes_one(T& trial) {
  kept(trial, [&](const Group& group, const Bytes&, const Bytes& turned) {
    const Pdu request = write_request(group, turned);
    const auto answer = trial.ask(request);
    if (answer && trial.expect(*answer == request, "the request repeated", answer_words(*answer))) {
      const auto now = read(trial, {group});
      if (now) {
        trial.expect(now->front() == turned, hex_text(turned) + " read back",
                     hex_text(now->front()));
      }
    }
  });
}

/// A request that has to be refused, of the writable record's new bytes: nothing changes.
template <class Make>
void writes_nothing(T& trial, ExceptionCode code, const Make& make) {
  kept(trial, [&](const Group& group, const Bytes& before, const Bytes& turned) {
    trial.refuses(make(group, turned), code);
    const auto now = read(trial, {group});
    if (now) {
      trial.expect(now->front() == before, "the record as it was", hex_text(now->front()));
    }
  });
}

void writes_other_type(T& trial) {
  writes_nothing(trial, ExceptionCode::illegal_data_address, [](Group group, const Bytes& data) {
    group.type = 7;
    return write_request(group, data);
  });
}

void writes_file_0(T& trial) {
  writes_nothing(trial, ExceptionCode::illegal_data_address, [](Group group, const Bytes& data) {
    group.file = 0;
    return write_request(group, data);
  });
}

void writes_record_10000(T& trial) {
  writes_nothing(trial, ExceptionCode::illegal_data_address, [](Group group, const Bytes& data) {
    group.record = kRecords;
    return write_request(group, data);
  });
}

void writes_less_than_it_says(T& trial) {
  writes_nothing(trial, ExceptionCode::illegal_data_value, [](Group group, const Bytes& data) {
    group.count = 2;
    return write_request(group, data);
  });
}

void writes_short(T& trial) {
  writes_nothing(trial, ExceptionCode::illegal_data_value,
                 [](const Group& group, const Bytes&) { return write_request(group, {}); });
}

/// How many are in the first queue that is claimed.
std::optional<unsigned> queued(T& trial) {
  const auto data = trial.accepts(fields_pdu(kQueue, {trial.claims().queues.front()}));
  if (!data || !trial.expect(data->size() >= 4, "a byte count and a count", hex_text(*data))) {
    return std::nullopt;
  }
  const unsigned bytes = (*data)[0] * 256U + (*data)[1];
  const unsigned count = (*data)[2] * 256U + (*data)[3];
  const bool right = trial.expect(count <= kMostQueued, "31 at most", std::to_string(count)) &&
                     trial.expect(bytes == 2 + 2 * count && data->size() == 2U + bytes,
                                  "a byte count of the count and its registers, and as many bytes",
                                  hex_text(*data, 16));
  return right ? std::optional(count) : std::nullopt;
}

void stays_queued(T& trial) {
  const auto before = queued(trial);
  const auto after = before ? queued(trial) : std::nullopt;
  if (after) {
    trial.expect(*after >= *before, "no fewer: reading takes nothing out", std::to_string(*after));
  }
}

void no_queue(T& trial) {
  const auto& queues = trial.claims().queues;
  unsigned address = 0xFFFF;
  while (std::ranges::find(queues, address) != queues.end()) {
    --address;
  }
  trial.refuses(fields_pdu(kQueue, {address}), ExceptionCode::illegal_data_address);
}

struct FileRow {
  std::uint8_t function;
  const char* section;
  const char* title;
  void (*run)(T&);
  Strength strength = Strength::must;
  bool writes = false;
};
constexpr auto kNoAddress = ExceptionCode::illegal_data_address;

const std::array kFileRows{
    FileRow{kRead, "6.14", "A record is read", reads_one},
    FileRow{kRead, "6.14", "A record is the same when read again", reads_twice},
    FileRow{kRead, "6.14", "Two groups are read at once", reads_groups},
    FileRow{kRead, "6.14", "Each record alone as in a block", reads_block},
    FileRow{kRead, "6.14", "A reference type other than 6 is refused",
            [](T& t) {
              Group group = first(t);
              group.type = 5;
              refused(t, group, kNoAddress);
            }},
    FileRow{kRead, "6.14", "File 0 is refused",
            [](T& t) {
              refused(t, {0, 0}, kNoAddress);
            }},
    FileRow{kRead, "6.14", "A file that there is not is refused", other_file},
    FileRow{kRead, "6.14", "Record 10000 is refused",
            [](T& t) {
              refused(t, {first(t).file, kRecords}, kNoAddress);
            }},
    FileRow{kRead, "6.14", "Records that begin in a file and end outside are refused",
            beyond_the_file},
    FileRow{kRead, "6.14", "A length below 7 is refused", odd_length},
    FileRow{kRead, "6.14", "A length above 245 is refused", too_long},
    FileRow{kRead, "6.14", "A request that ends within its group is refused", cut_off, kShould},
    FileRow{kWrite, "6.15", "A record is written and read back", writes_one, kMust, true},
    FileRow{kWrite, "6.15", "A reference type other than 6 is refused, nothing changes",
            writes_other_type, kMust, true},
    FileRow{kWrite, "6.15", "File 0 is refused, nothing changes", writes_file_0, kMust, true},
    FileRow{kWrite, "6.15", "Record 10000 is refused, nothing changes", writes_record_10000, kMust,
            true},
    FileRow{kWrite, "6.15", "A length below 9 is refused, nothing changes", writes_short, kMust,
            true},
    FileRow{kWrite, "6.15", "Fewer records than are said are refused, nothing changes",
            writes_less_than_it_says, kShould, true},
    FileRow{kQueue, "6.18", "A queue is read: its count, at most 31, and as many registers",
            [](T& t) { static_cast<void>(queued(t)); }},
    FileRow{kQueue, "6.18", "Reading takes nothing out of the queue", stays_queued},
    FileRow{kQueue, "6.18", "An address that is no queue is refused", no_queue},
    FileRow{kQueue, "6.18", "A request that ends within its address is refused",
            [](T& t) {
              t.refuses({kQueue, 0}, ExceptionCode::illegal_data_value);
            },
            kShould},
};

}  // namespace

std::vector<ModbusCase> modbus_file_cases() {
  std::vector<ModbusCase> all;
  Citations citations("modbus", kApplicationProtocol);
  for (const FileRow& row : kFileRows) {
    ModbusCase& made = all.emplace_back();
    made.identity = citations.next(row.section, row.title, row.strength,
                                   row.writes ? Danger::writes : Danger::none);
    made.needs.function = row.function;
    made.needs.file = row.function != kQueue;
    made.needs.writable_file = row.writes;
    made.needs.queue = row.function == kQueue;
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
