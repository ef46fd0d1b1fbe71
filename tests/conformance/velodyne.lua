-- A Velodyne dissector for tshark: HDL-32E, VLP-16 and Puck Hi-Res with one return. Written from the
-- manuals (63-9113 Rev. H, 63-9243 Rev. D) and sharing nothing with protocols/velodyne: angles are
-- computed from the rule of the optics (two halves of the fan alternate, one pitch), times from the
-- firing order. All other models and modes: velodyne_points.py.
--
--   tshark -X lua_script:velodyne.lua -r capture.pcap -T fields -e velodyne.point ...
--
-- One field "velodyne.point" per return: block place range_m azimuth_deg elevation_deg offset_us
-- reflectivity. Anything against the manual adds a "velodyne.complaint".

local velodyne = Proto("velodyne", "Velodyne data")
local position = Proto("velodyne_position", "Velodyne position")

local fields = {
  point = ProtoField.string("velodyne.point", "Point"),
  stamp = ProtoField.uint32("velodyne.timestamp", "Microseconds past the hour"),
  mode = ProtoField.uint8("velodyne.mode", "Return mode", base.HEX),
  product = ProtoField.uint8("velodyne.product", "Product", base.HEX),
  complaint = ProtoField.string("velodyne.complaint", "Against the manual"),
}
velodyne.fields = { fields.point, fields.stamp, fields.mode, fields.product, fields.complaint }

local place = {
  stamp = ProtoField.uint32("velodyne_position.timestamp", "Microseconds past the hour"),
  pulse = ProtoField.uint8("velodyne_position.pulse", "Pulse per second"),
  sentence = ProtoField.string("velodyne_position.sentence", "Sentence"),
  complaint = ProtoField.string("velodyne_position.complaint", "Against the manual"),
}
position.fields = { place.stamp, place.pulse, place.sentence, place.complaint }

-- By product id. Even lasers climb from `bottom`, odd ones from `middle`, both by `pitch`; a firing of
-- `lasers` takes `period` microseconds, one laser after the other `spacing`.
local models = {
  [0x21] = { lasers = 32, bottom = -92 / 3, middle = -28 / 3, pitch = 4 / 3, period = 46.08,
    spacing = 1.152 },
  [0x22] = { lasers = 16, bottom = -15, middle = 1, pitch = 2, period = 55.296, spacing = 2.304 },
  [0x24] = { lasers = 16, bottom = -10, middle = 2 / 3, pitch = 4 / 3, period = 55.296,
    spacing = 2.304 },
}

local function elevation(model, laser)
  local start = laser % 2 == 0 and model.bottom or model.middle
  return start + math.floor(laser / 2) * model.pitch
end

local function azimuth_at(buffer, block)
  return buffer(block * 100 + 2, 2):le_uint() / 100
end

local function turn(from, to)
  local step = to - from
  if step < 0 then step = step + 360 end
  return step
end

function velodyne.dissector(buffer, packet, root)
  packet.cols.protocol = "Velodyne"
  local tree = root:add(velodyne, buffer())
  if buffer:len() ~= 1206 then
    tree:add(fields.complaint, "length " .. buffer:len())
    return
  end
  local model = models[buffer(1205, 1):uint()]
  if model == nil then
    tree:add(fields.complaint, "product id")
    return
  end
  local firings = 32 / model.lasers
  for block = 0, 11 do
    local at = block * 100
    if buffer(at, 1):uint() ~= 0xff or buffer(at + 1, 1):uint() ~= 0xee then
      tree:add(fields.complaint, "flag of block " .. block)
    end
    local azimuth = azimuth_at(buffer, block)
    if azimuth >= 360 then
      tree:add(fields.complaint, "azimuth of block " .. block)
    end
    local step
    if block < 11 then
      step = turn(azimuth, azimuth_at(buffer, block + 1))
    else
      step = turn(azimuth_at(buffer, block - 1), azimuth)
    end
    for place = 0, 31 do
      local channel = buffer(at + 4 + place * 3, 3)
      local counts = channel(0, 2):le_uint()
      if counts > 0 then
        local laser = place % model.lasers
        local since = math.floor(place / model.lasers) * model.period + laser * model.spacing
        local shot = azimuth + step * since / (firings * model.period)
        if shot >= 360 then shot = shot - 360 end
        tree:add(fields.point, channel, string.format("%d %d %.3f %.5f %.4f %.3f %d", block, place,
          counts * 0.002, shot, elevation(model, laser), block * firings * model.period + since,
          channel(2, 1):uint()))
      end
    end
  end
  tree:add_le(fields.stamp, buffer(1200, 4))
  if buffer(1200, 4):le_uint() >= 3600000000 then
    tree:add(fields.complaint, "timestamp past the hour")
  end
  tree:add(fields.mode, buffer(1204, 1))
  tree:add(fields.product, buffer(1205, 1))
end

function position.dissector(buffer, packet, root)
  packet.cols.protocol = "Velodyne position"
  local tree = root:add(position, buffer())
  if buffer:len() ~= 512 then
    tree:add(place.complaint, "length " .. buffer:len())
    return
  end
  for i = 0, 13 do
    if buffer(i, 1):uint() ~= 0 then tree:add(place.complaint, "byte " .. i .. " is not zero") end
  end
  tree:add_le(place.stamp, buffer(198, 4))
  tree:add(place.pulse, buffer(202, 1))
  local sentence = buffer(206, 306):stringz()
  local body, sum = sentence:match("^%$(GPRMC,[^*]*)%*(%x%x)\r\n$")
  local check = 0
  if body == nil then
    tree:add(place.complaint, "no GPRMC sentence")
    return
  end
  for i = 1, #body do
    -- Exclusive or without an operator: the Lua of tshark 4.0 is 5.2.
    check = bit32.bxor(check, body:byte(i))
  end
  if check ~= tonumber(sum, 16) then tree:add(place.complaint, "checksum") end
  tree:add(place.sentence, buffer(206, #sentence), body)
end

DissectorTable.get("udp.port"):add(2368, velodyne)
DissectorTable.get("udp.port"):add(8308, position)
