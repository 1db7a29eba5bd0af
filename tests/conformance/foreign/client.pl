#!/usr/bin/perl
# A second, independent client of fapstream.v1, written from SPEC.md and schema/ alone, to try a server with:
#     client.pl HOST:PORT [ACT ...]    acts: speak pacing interrupt resume listen pause splice seek errors queue ahead live
# It prints "ok - ACT" for each; the first deviation from the SPEC ends it with a message and status 1. It needs
# libprotocol-websocket-perl, libdata-messagepack-perl, and schema/ next to it, above it or in $FAPSTREAM_SCHEMA.
use strict;
use warnings;
use utf8;
use Data::MessagePack;
use Encode qw(encode_utf8);
use FindBin;
use IO::Select;
use IO::Socket::INET;
use JSON::PP ();
use List::Util qw(max min sum);
use POSIX qw(ceil);
use Protocol::WebSocket::Frame;
use Protocol::WebSocket::Handshake::Client;
use Socket qw(SOL_SOCKET SO_LINGER);
use Time::HiRes qw(sleep time);

binmode $_, ':encoding(UTF-8)' for *STDOUT, *STDERR;
$| = 1;
$SIG{PIPE} = 'IGNORE';
my ($ADDRESS, @ACTS) = @ARGV;
my ($ACT, @ALL) = 'start';    # the act, and all its connections
sub fail { warn "not ok - $ACT: ", @_, "\n"; exit 1 }
sub check($@) { my ($true, @text) = @_; $true or fail(@text) }    # the prototype: what is checked is a scalar
sub show { join ' ', map JSON::PP->new->canonical->allow_nonref->encode($_), @_ }
check(($ADDRESS // '') =~ /^[^:\s]+:\d+$/, 'usage: client.pl HOST:PORT [ACT ...]');

# ---- schema/ ----
my ($SCHEMA) = grep -f "$_/messages.json", $ENV{FAPSTREAM_SCHEMA} // (), map "$FindBin::Bin/${_}schema", '', '../', '../../';
sub table { open my $f, '<:raw', "$SCHEMA/$_[0].json" or fail("$_[0].json: $!"); local $/; JSON::PP::decode_json(<$f>) }
check($SCHEMA, 'schema/messages.json is not found');
my ($TABLE, $STATES) = (table('messages'), table('session'));
my %MESSAGE = map { $_->{name} => $_ } @{ $TABLE->{messages} };
my %FATAL = map { $_->{code} => $_->{fatal} } @{ table('errors') };
my %LIMIT = %{ $TABLE->{limits} };

# ---- SPEC 2: encoding ----
my ($BIN, $STR) = (Data::MessagePack->new, Data::MessagePack->new->utf8);    # they differ in what a string becomes
my $TRUE = Data::MessagePack::true();
sub str { utf8::upgrade(my $string = $_[0]); $STR->pack($string) }

sub encode {    # TYPE, FIELD => VALUE ...; a reference to bytes becomes bin, what looks like an int is one
    my ($type, @fields) = @_;
    my $bytes = chr(0x81 + @fields / 2) . str('type') . str($type);    # a hash would not keep type first
    while (my ($name, $value) = splice @fields, 0, 2) {
        $bytes .= str($name) . (ref $value eq 'SCALAR' ? $BIN->pack($$value) : ref $value ? $BIN->pack($value)
            : $value =~ /^-?\d+$/ ? $BIN->pack(0 + $value) : str($value));
    }
    return $bytes;
}

# what a value of a type begins with on the wire, and how `bin` is unpacked
my %BEGINS = (int => qr/[\x00-\x7f\xcc-\xd3\xe0-\xff]/, str => qr/[\xa0-\xbf\xd9-\xdb]/, bool => qr/[\xc2\xc3]/,
    list => qr/[\x90-\x9f\xdc\xdd]/, map { $_ => qr/[\xc4-\xc6]/ } qw(u8 i16 i32));
my %UNPACK = (u8 => 'C*', i16 => 's<*', i32 => 'l<*');

sub decode {
    my ($bytes) = @_;
    $bytes =~ /^(?:[\x80-\x8f]|\xde..)\xa4type/s or fail('not a map with type first: ', unpack 'H*', $bytes);
    my $map = $BIN->unpack($bytes);
    my $fields = ($MESSAGE{ $map->{type} } // return)->{fields};
    return { type => $map->{type}, %{ conform($map->{type}, $fields, $map, $bytes) } };
}

sub conform {    # the known fields of a map, held against the schema
    my ($where, $fields, $map, $bytes) = @_;
    my %known;
    for my $field (@$fields) {
        my ($name, $type, $of) = @$field{qw(name type of)};
        my $value = $map->{$name};
        if (!exists $map->{$name}) { check($field->{optional}, "$where.$name is missing"); next }
        $bytes =~ (str($name) . $BEGINS{$type}) or fail("$where.$name is no $type: ", unpack 'H*', $bytes);
        $value = [unpack $UNPACK{$type}, $value] if $UNPACK{$type};
        $value = [map ref ? conform("$where.$name", $TABLE->{structs}{$of}, $_, $bytes) : $_, @$value] if $of;
        my $size = $type eq 'bool' ? 0 : ref $value ? @$value : $type eq 'str' ? length $value : $value;
        check($size >= ($field->{min} // $size) && $size <= ($field->{max} // $size) && abs $size < 2**53, "$where.$name: $size");
        check(!$field->{enum} || grep({ $_ eq $value } @{ $field->{enum} }), "$where.$name: $value");
        $known{$name} = $type eq 'bool' ? ($value ? 1 : 0) : $value;
    }
    return \%known;
}

# ---- SPEC 1: transport ----
sub dial {    # a socket after the handshake, and the bytes that came behind that; nothing if it was refused
    my ($subprotocol) = @_;
    my $socket = IO::Socket::INET->new(PeerAddr => $ADDRESS, Timeout => 5) or fail("$ADDRESS: $!");
    my $hand = Protocol::WebSocket::Handshake::Client->new(url => "ws://$ADDRESS/ws");
    $hand->req->subprotocol($subprotocol) if $subprotocol;
    syswrite $socket, $hand->to_string;
    my $bytes = '';
    until ($bytes =~ /\r\n\r\n/) { sysread $socket, $bytes, 4096, length $bytes or fail('closed during the handshake') }
    return unless $bytes =~ m{^HTTP/1.1 101};
    check($hand->parse($bytes) && $hand->is_done && $hand->res->subprotocol eq $subprotocol, 'handshake: ', $hand->error);
    return ($socket, $bytes);
}

sub frame {
    my ($c, $type, $bytes) = @_;
    $bytes = Protocol::WebSocket::Frame->new(type => $type, masked => 1, buffer => $bytes, max_payload_size => 0)->to_bytes;
    while (length $bytes) { substr $bytes, 0, syswrite($c->{socket}, $bytes) // return, '' }
}

sub receive {    # the next message that has come, if any
    my ($c) = @_;
    while (defined(my $bytes = $c->{frames}->next_bytes)) {
        my $opcode = $c->{frames}->opcode;
        if ($opcode == 8) { frame($c, close => $bytes); $c->{closed} = unpack('n', $bytes) // 1005; return }
        if ($opcode == 9) { frame($c, pong => $bytes); next }
        next if $opcode == 10;
        check($opcode == 2 && length $bytes <= $LIMIT{max_message_bytes}, "frame of type $opcode, ", length $bytes, ' bytes');
        return decode($bytes) // ($c->{received}++, next);    # an unknown message is skipped, but it counts
    }
    return;
}

sub pump {    # read from all connections, one message after the other, until something is true
    my ($until, $within, $what) = @_;
    my $end = time + $within;
    until ($until->()) {
        check(time < $end, "no $what within $within s");
        fail("no $what, but code $_->{closed}") for grep $_->{closed} && $_->{state} ne 'closed', @ALL;
        my ($c, $m);
        for (@ALL) { $c = $_; last if $m = receive($c) }
        if ($m) { took($c, $m); next }
        for my $c (grep !$_->{closed}, @ALL) {
            play($c);
            my $bytes;
            next unless IO::Select->new($c->{socket})->can_read(0.01 / @ALL);
            sysread($c->{socket}, $bytes, 65536) ? $c->{frames}->append($bytes) : ($c->{closed} = 1006);
        }
    }
}

# ---- SPEC 4.6, 4.3: states and counts ----
sub turn {
    my ($c, $id) = @_;
    return $c->{turns}{$id} //= { id => $id, state => $STATES->{turn}{start}, at => 0, heard => 0, pcm => '', marks => [],
        frames => {}, packets => 0, lead => 0 };
}

sub move {    # the states of session and turn after a message of one side; those of the server have to fit
    my ($side, $c, $m) = @_;
    for ([session => $c], $m->{turn} ? [turn => turn($c, $m->{turn})] : ()) {
        my ($kind, $it) = @$_;
        my $to = $STATES->{$kind}{$side}{ $it->{state} }{ $m->{type} };
        $to || $side eq 'client' or fail("does not fit a $kind that is $it->{state}: ", show($m));
        $it->{state} = $to // $it->{state};
    }
}

sub post {    # send a message, and keep it if it counts; while $c->{lost} is set it gets lost on the way
    my ($c, $type, %fields) = @_;
    move('client', $c, { type => $type, %fields });
    my $bytes = encode($type, %fields);
    push @{ $c->{sent} }, $bytes unless ($MESSAGE{$type} // {})->{ephemeral};
    frame($c, binary => $bytes) unless $c->{lost};
}

sub logged { my ($c, $type) = @_; return grep $_->{type} eq $type, @{ $c->{log} } }

sub took {
    my ($c, $m) = @_;
    my $type = $m->{type};
    return if $c->{state} eq 'closed';    # it crossed our bye
    $c->{received}++ unless $MESSAGE{$type}{ephemeral};
    push @{ $c->{log} }, $m;
    move('server', $c, $m);
    $c->{ready} = $m if $type eq 'ready';
    if ($type eq 'error') {
        check(!!($FATAL{ $m->{code} } // $m->{fatal}) eq !!$m->{fatal} && $c->{expect}{ $m->{code} }, show($m));
        $c->{state} = 'closed' if $m->{fatal};
    }
    if (my $take = $m->{turn} && main->can("took_$type")) { $take->($c, turn($c, $m->{turn}), $m) }
}

# ---- SPEC 3, 4: what comes of a turn, held against what came before ----
sub took_begin {
    my ($c, $t, $m) = @_;
    my ($voice) = grep $_->{name} eq $m->{voice}, @{ $c->{ready}{voices} };
    check($voice && $voice->{sample_rate} == $m->{sample_rate} && $m->{fps} == $c->{ready}{fps}, 'not as in ready: ', show($m));
    check(!$t->{begin} && ($c->{state} eq 'listening' || !$m->{sample}), show($m));
    @$t{qw(begin from at heard)} = ($m, ($m->{sample} // 0) x 3);
}

sub took_packet {
    my ($c, $t, $m) = @_;
    my ($first, $begin, $channels) = ($m->{sample}, $t->{begin}, scalar @{ $c->{ready}{faps} });
    my $here = "turn $t->{id}, packet at $first";
    check($begin && $first == $t->{at} && $m->{pcm}, "$here: no begin, no sound, or not at $t->{at}");
    my ($rate, $fps) = @$begin{qw(sample_rate fps)};
    my $missing = $rate * $LIMIT{packet_ms} / 1000 - @{ $m->{pcm} };
    check(!$t->{short} && $missing >= 0 && !exists $m->{samples}, "$here: not 40 ms long, or the one before");
    $t->{short} = $missing > 0 && $first + @{ $m->{pcm} } != ($t->{cut} // -1);    # only one that ends there or the turn
    check(!defined $t->{cut} || $first >= $t->{cut} || $first + @{ $m->{pcm} } <= $t->{cut}, "$here: across a discard");
    $t->{at} += @{ $m->{pcm} };
    $t->{pcm} .= pack 's<*', @{ $m->{pcm} };
    # 3.2: keys, and the frames out of the masks
    @$t{qw(face unkeyed)} = ([(0) x $channels], 0) if $m->{key};
    check($t->{face} && $t->{unkeyed}++ < $LIMIT{key_packets}, "$here: should be a key");
    my ($bytes, $k, $next) = map ceil($_), $channels / 8, $first * $fps / $rate, $t->{at} * $fps / $rate;
    my ($mask, @values) = ($m->{mask} // [], @{ $m->{wide} // $m->{faps} // [] });
    check(@$mask == ($next - $k) * $bytes && !$m->{mask} == ($next == $k), "$here: not a mask of ", $next - $k, ' frames');
    check(!($m->{faps} && $m->{wide}) && (!$m->{wide} || grep abs > 32767, @values), "$here: wide without need");
    for (; $k < $next; $k++) {
        my @bits = splice @$mask, 0, $bytes;
        for my $b (grep $bits[$_ >> 3] & 1 << ($_ & 7), 0 .. 8 * $bytes - 1) {
            check($b < $channels && @values > 0, "$here: bit $b is set without a channel or value");
            $t->{face}[$b] = shift @values;
        }
        $t->{frames}{$k} = "@{ $t->{face} }";
    }
    check(!@values, "$here: values are left over: @values");
    # 3.1: marks are in order and not late; how far the server is ahead
    my $last = $first;
    for my $mark (@{ $m->{marks} // [] }) {
        check($mark->{sample} >= $last, "$here: late or out of order: ", show($mark));
        $last = $mark->{sample};
        push @{ $t->{marks} }, $mark;
    }
    my $now = time;
    $t->{packets}++;
    $t->{lead} = max($t->{lead}, ($t->{at} - $t->{from}) / $rate - ($now - ($t->{since} //= $now)));
}

sub took_discard {    # 4.2
    my ($c, $t, $m) = @_;
    my $from = $m->{sample};
    @$t{qw(discard cut short face)} = ($m, $from);    # the next packet may follow a short one and has to be a key
    if ($from < $t->{at}) {
        $t->{at} = $from;
        substr($t->{pcm}, 2 * ($from - $t->{from})) = '';
    }
    delete $t->{frames}{$_} for grep $_ * $t->{begin}{sample_rate} / $t->{begin}{fps} >= $from, keys %{ $t->{frames} };
    $t->{marks} = [grep $_->{sample} < $from, @{ $t->{marks} }];
}

sub took_done {
    my ($c, $t, $m) = @_;
    $t->{done} = $m;
    check($m->{samples} == $t->{at} && ($m->{reason} eq 'interrupted') == defined $m->{heard}, "$t->{at} came: ", show($m));
}

sub play {    # 3.1: hear what there is by the clock, and acknowledge it four times a second
    my ($c) = @_;
    my ($now, $before) = (time, $c->{played} // time);
    $c->{played} = $now;
    my ($t) = grep { $_->{begin} && !($_->{done} && $_->{heard} >= ($_->{done}{heard} // $_->{at})) }
        map $c->{turns}{$_}, sort { $a <=> $b } keys %{ $c->{turns} };
    return if !$t;
    $t->{heard} = min($t->{at}, $t->{heard} + ($now - $before) * $t->{begin}{sample_rate}) if !$c->{deaf};
    return if $now < ($c->{acked} // 0) + 0.25;
    $c->{acked} = $now;
    my %state = (sample => int $t->{heard}, queue => $t->{at} - int $t->{heard}, underruns => 0, skew => 0);
    post($c, 'ack', turn => $t->{id}, %state, received => $c->{received});
}

# ---- what the acts are made of ----
sub attach {    # 4.1, 4.3, 4.4, 4.5: a connection, `hello` or `listen`, and `ready`; again if the server says `busy`
    my ($c, $type, %fields) = @_;
    for my $try (1 .. 4) {
        ($c->{socket}, my $rest) = dial($TABLE->{subprotocol}) or fail('the handshake is refused');
        $c->{frames} = Protocol::WebSocket::Frame->new(max_payload_size => $LIMIT{max_message_bytes}, buffer => $rest);
        @$c{qw(state closed ready played)} = ($STATES->{session}{start});
        $c->{expect} = { busy => $try < 4 };
        post($c, $type, client => 'client.pl', %fields);
        pump(sub { $c->{ready} || $c->{closed} }, 5, 'ready');
        last if $c->{ready};
        sleep((logged($c, 'error'))[-1]{retry_ms} / 1000);
    }
    check(!grep({ $_ < 3 || $_ > 68 } @{ $c->{ready}{faps} }), 'not low-level: ', show($c->{ready}));
    return $c;
}

sub session { push @ALL, my $c = { turns => {}, log => [], sent => [], received => 0 }; return attach($c, @_) }
sub speaker { return session('hello', lang => 'en', @_) }

sub listener {    # 4.4
    my ($channel, $token) = @{ $_[0]{ready} }{qw(channel listen)};
    my $c = session('listen', channel => $channel // fail('no ready.channel'), $token ? (token => $token) : ());
    pump(sub { grep $_->{on} && $_->{talk} && $_->{channel} eq $channel, logged($c, 'live') }, 2, 'live');
    return $c;
}

sub leave { my ($c) = @_; post($c, 'bye'); pump(sub { $c->{closed} }, 2, 'end of the connection after bye') }

sub whole {    # a turn in one piece
    my ($c, $id, $text, %fields) = @_;
    post($c, 'speak', turn => $id, text => $text, %fields);
    post($c, 'end', turn => $id);
    return turn($c, $id);
}

sub pass { my $end = time + $_[0]; pump(sub { time >= $end }, $_[0] + 1, 'time') }
sub store { return sum map { ($_->{at} - $_->{heard}) / $_->{begin}{sample_rate} } grep $_->{begin}, @_ }    # in seconds
sub words { my ($t) = @_; return grep $_->{kind} eq 'word', @{ $t->{marks} } }
sub done { my ($t) = @_; pump(sub { $t->{done} }, 20, "done of turn $t->{id}"); return $t->{done} }

sub heard {    # so much of a turn
    my ($t, $seconds) = @_;
    pump(sub { $t->{begin} && $t->{heard} >= $seconds * $t->{begin}{sample_rate} }, 15, "$seconds s of turn $t->{id}");
    return int $t->{heard};
}

sub spoken {    # a turn to its end: it is sound, and the marks of words spell the text (or another, as a pattern)
    my ($t, $text, $words) = @_;
    check(done($t)->{reason} eq 'end', show($t->{done}));
    my %faces = reverse %{ $t->{frames} };
    check(max(map abs, unpack 's<*', $t->{pcm}) > 1000 && keys %faces > 5, "turn $t->{id}: still or silent");
    for (words($t)) {
        check(substr($text, $_->{char_start}, $_->{char_end} - $_->{char_start}) eq $_->{text}, 'not there: ', show($_));
    }
    my $said = join ' ', map $_->{text}, words($t);
    $words //= join ' ', $text =~ /\w+/g;
    check($said =~ /^$words$/, "turn $t->{id}: '$said' and not '$words'");
}

sub same {    # what a listener has of a turn is what its speaker has
    my ($l, $t) = @_;
    my $from = $l->{from};
    check(show(done($l)) eq show(done($t)) && $l->{pcm} eq substr($t->{pcm}, 2 * $from), "sound or done differs, from $from");
    check($l->{frames}{$_} eq $t->{frames}{$_}, "frame $_ differs") for keys %{ $l->{frames} };
    my @marks = map show(grep $_->{sample} >= $from, @{ $_->{marks} }), $l, $t;
    check($marks[0] eq $marks[1], "marks differ: @marks");
}

sub counted {    # 4.3: `pong` says how many messages the server has counted
    my ($c) = @_;
    $c->{log} = [];
    post($c, 'ping', id => 4294967295);
    pump(sub { logged($c, 'pong') }, 2, 'pong');
    my ($sent, $pong) = (scalar @{ $c->{sent} }, logged($c, 'pong'));
    check($pong->{id} == 4294967295 && ($pong->{received} // $sent) == $sent, "$sent were sent: ", show($pong));
}

# ---- the acts ----
my $TALK = 'The old harbour was quiet that morning, and the boats lay still beside the wall.';
my %act;
$act{speak} = sub {    # 1, 2, 3, 4.1
    check(!dial(), 'a handshake without a subprotocol is not refused');
    my $c = speaker(tomorrow => 'fields that are not known are skipped');
    my $text = 'My naïve café friend sings. Then she counts to three.';
    my ($t, @pieces) = (turn($c, 1), unpack 'a6 a8 a19 a*', encode_utf8($text));    # cut inside ï and é
    post($c, 'speak', turn => 1, text => \$_, rate => 150) for @pieces;
    post($c, 'end', turn => 1);
    spoken($t, $text);
    spoken(my $again = whole($c, 2, $text, rate => 150), $text);
    check($again->{pcm} eq $t->{pcm}, 'the sound depends on the cuts');
};
$act{pacing} = sub {    # 3.1
    my $c = speaker();
    my $t = whole($c, 1, "$TALK $TALK");
    heard($t, 3);
    check($t->{lead} > 0.5, "the server was only $t->{lead} s ahead");
    $c->{deaf} = 1;    # nothing is heard, so that the store grows
    pass(1.5);
    check(store($t) < 2.3, store($t), ' s in store, though acknowledgements say so');
    $c->{deaf} = 0;
    heard($t, 4);
    check($t->{lead} < 1.8, "the server was $t->{lead} s ahead");
};
$act{interrupt} = sub {    # 4.2
    my $c = speaker();
    my @t = (undef, (map whole($c, $_, $TALK), 1 .. 3), whole($c, 4, 'Over.'));
    my $heard = heard($t[1], 1.3);
    post($c, 'interrupt', turn => 1, heard => $heard);
    post($c, 'interrupt', turn => 3);    # which waits
    my $done = join ' ', map @{ done($_) }{qw(reason heard char)}, @t[1, 3];
    my $char = max(0, map $_->{char_end}, grep $_->{sample} < $heard, words($t[1]));
    check($done eq "interrupted $heard $char interrupted 0 0", "heard $heard, char $char: $done");
    heard($t[2], 0.3);
    post($c, 'interrupt', turn => 2, heard => 2**40);
    post($c, 'speak', turn => 2, text => 'This is ignored.');
    check(done($t[2])->{reason} eq 'interrupted' && $t[2]{done}{heard} == $t[2]{at}, 'not clamped: ', show($t[2]{done}));
    spoken($t[4], 'Over.');
};
$act{resume} = sub {    # 4.3
    my $c = speaker();
    my $t = turn($c, 1);
    my $resume = sub {    # connect again, send what the server has not got, and let it count
        my $key = $c->{ready}{resume} // fail('no ready.resume');
        my $ready = attach($c, 'hello', lang => 'en', resume => $key, received => $c->{received})->{ready};
        my ($sent, $there) = (scalar @{ $c->{sent} }, $ready->{resumed} ? $ready->{received} // -1 : -1);
        check($there >= 0 && $there <= $sent && ($ready->{resume} // "") eq $key, "$sent were sent: ", show($ready));
        frame($c, binary => $_) for @{ $c->{sent} }[$there .. $sent - 1];
        counted($c);
        return $there;
    };
    my @part = unpack '(a16)5', $TALK;
    post($c, 'speak', turn => 1, text => $_) for @part[0 .. 2];
    heard($t, 1);
    sleep 0.5;    # what comes now is not read any more
    post($c, 'speak', turn => 1, text => $part[3]);    # may get through or not
    $c->{lost} = 1;
    post($c, 'speak', turn => 1, text => $part[4]);    # does not
    $c->{lost} = 0;
    setsockopt $c->{socket}, SOL_SOCKET, SO_LINGER, pack 'ii', 1, 0;    # closes by a reset
    close $c->{socket};
    sleep 1;
    my $there = $resume->();
    check($there == 3 || $there == 4, "the server says that it has $there messages");
    heard($t, 2);
    my $old = $c->{socket};    # held open: the server has not missed it
    check($resume->() == 5, 'messages are missing, though none was lost');
    post($c, 'end', turn => 1);
    spoken($t, $TALK);    # and no packet is missing and none comes twice: took_packet
};
$act{listen} = sub {    # 4.4
    my $c = speaker(share => $TRUE);
    my $early = listener($c);
    my $t = whole($c, 1, $TALK);
    heard($t, 1.5);
    my $late = listener($c);
    my ($e, $l) = map turn($_, 1), $early, $late;
    spoken($_, $TALK, $_ == $l ? '.* beside the wall' : undef) for $t, $e, $l;
    check($t->{lead} < 0.8 && $e->{from} == 0 && $l->{from} > 0, "ahead by $t->{lead} s: ", show($l->{begin}));
    same($_, $t) for $e, $l;
    for my $kind (qw(word caption)) {
        my ($is, $in_force) = map { show((grep $_->{kind} eq $kind && $_->{sample} <= $l->{from}, @$_)[-1]) }
            $l->{begin}{marks} // [], $t->{marks};
        check($is eq $in_force, "begin.marks: $is and not $in_force");
    }
};
$act{pause} = sub {    # 4.2, 4.4
    my $c = speaker(share => $TRUE);
    my ($l, $text) = (listener($c), $TALK =~ /^(.*?),/);
    my ($t, $next) = (whole($c, 1, $text), whole($c, 2, 'Over.'));
    my $heard = heard($t, 1);
    post($c, 'pause', turn => 1, heard => $heard);
    $c->{deaf} = 1;
    pass(0.4);    # what was on its way
    my $at = $t->{at};
    pass(0.8);
    check($t->{at} == $at && !$next->{begin}, 'packets come though the turn pauses');
    post($c, 'continue', turn => 1);
    $c->{deaf} = 0;
    spoken($t, $text);
    spoken($next, 'Over.');
    same(turn($l, $_->{id}), $_) for $t, $next;
    my $told = show(map logged($l, $_), qw(pause continue));
    check($told eq show({ type => 'pause', turn => 1, heard => $heard }, { type => 'continue', turn => 1 }), "told: $told");
};
$act{splice} = sub {    # 4.2
    my $c = speaker();
    my ($keep, $new, $last) = ('The first sentence stays. ', 'Other words are said instead, and more.', ' and this ends it.');
    my $t = whole($c, 1, $keep . 'The second was wrong.');
    my $splice = sub {
        my ($char, $seconds, $text) = @_;
        my $heard = heard($t, $seconds);
        delete $t->{discard};
        post($c, 'splice', turn => 1, char => $char, heard => $heard);
        whole($c, 1, $text);
        pump(sub { $t->{discard} }, 2, 'discard');
        check($t->{discard}{sample} >= $heard, "$heard samples were heard: ", show($t->{discard}));
        return $t->{discard}{char};
    };
    check($splice->(length $keep, 0.7, $new) == length $keep, 'nothing of it had been heard: ', show($t->{discard}));
    my $char = $splice->(4, 1, $last);    # that has been heard: it goes on behind the word being heard
    my ($begun) = reverse grep $_->{sample} < $t->{heard}, words($t);
    check($char >= $begun->{char_end}, 'had been heard: ', show($begun, $t->{discard}));
    spoken($t, substr("$keep$new", 0, $char) . $last);
};
$act{seek} = sub {    # 4.2, 4.4
    my $c = speaker(share => $TRUE);
    my ($l, $one, $two) = (listener($c), 'One is short. ', 'The second is said again.');
    my $t = whole($c, 1, $one . $two);
    pump(sub { grep $_->{text} eq 'second' && $_->{sample} < $t->{heard}, words($t) }, 10, 'second sentence');
    my $heard = int $t->{heard};
    post($c, 'seek', turn => 1, back => 0, heard => $heard);
    pump(sub { $t->{discard} }, 2, 'discard');
    check($t->{discard}{char} == length $one && $t->{discard}{sample} >= $heard, "heard $heard: ", show($t->{discard}));
    spoken($t, $one . $two, 'One is short The second.* The second is said again');
    same(turn($l, 1), $t);
};
$act{errors} = sub {    # 1, 4.1, 4.3, 4.6, 5
    my $c = speaker();
    my $error = sub {
        my ($code, $turn) = @_;
        ($c->{expect}, $c->{log}) = ({ $code => 1 }, []);
        pump(sub { logged($c, 'error') }, 3, $code);
        my ($error) = logged($c, 'error');
        check(!$turn || ($error->{turn} // 0) == $turn, 'of which turn? ', show($error));
    };
    my $t = whole($c, 1, 'Nobody says this.', voice => 'nobody');
    $error->('unknown_voice', 1);
    check(done($t)->{reason} eq 'failed' && !$t->{begin}, show($t->{done}));
    post($c, 'speak', turn => 2);    # without text
    $error->('bad_message');
    my $fine = whole($c, 3, 'Fine.');
    post($c, 'speak', turn => 3, text => 'Not after the end.');
    $error->('bad_message');
    post($c, 'tomorrow', text => 'messages that are not known are skipped');
    counted($c);
    spoken($fine, 'Fine.');
    post($c, 'hello', lang => 'en');
    $error->('protocol');
    pump(sub { $c->{closed} }, 3, 'end of the connection');
};
$act{queue} = sub {    # 3.1 again: turns that follow each other do not add their leads up
    my $c = speaker();
    my @t = map whole($c, $_, 'The old harbour was quiet.'), 1 .. 3;
    heard($t[0], 1.5);
    check(store(@t) < 1.8, 'the server is ', store(@t), ' s ahead');
};
$act{ahead} = sub {    # 4.2 again: what a splice drops has not even been sent
    my $c = speaker();
    my ($keep, $new) = ('The first sentence is so long that its end is not under way. ', 'Other words are said.');
    my $t = whole($c, 1, $keep . 'The second was wrong.');
    post($c, 'splice', turn => 1, char => length $keep, heard => heard($t, 0.3));
    spoken(whole($c, 1, $new), $keep . $new);
    check($t->{discard} && $t->{discard}{char} == length $keep, 'discard: ', show($t->{discard}));
};
$act{live} = sub {    # 4.4: the first listener is told at once that somebody is there, and at last that he left
    my $c = speaker(share => $TRUE);
    my $l = listener($c);
    leave($c);
    pump(sub { !(logged($l, 'live'))[-1]{on} }, 2, 'live that is off');
    check("@{[map $_->{on}, logged($l, 'live')]}" eq '1 0', show(logged($l, 'live')));
};

for (@ACTS ? @ACTS : qw(speak pacing interrupt resume listen pause splice seek errors queue ahead live)) {
    ($ACT, @ALL) = $_;
    ($act{$ACT} // fail('there is no such act'))->();
    leave($_) for grep !$_->{closed}, @ALL;
    print "ok - $ACT\n";
}
